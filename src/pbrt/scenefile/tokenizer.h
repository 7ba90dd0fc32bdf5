#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/float.h"

namespace pbrt {

constexpr bool EndsWord(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '"' || c == '[' || c == ']';
}

/// Parses a number at `begin`: decimal or hexadecimal, optional sign, no inf or nan. Returns the position after it, or
/// `begin` if there is none. Underflow gives 0; overflow sets *overflow and leaves
/// *value unchanged, so that no infinity enters the scene.
const char *ScanFloat(const char *begin, const char *end, Float *value, bool *overflow);

/// The same for integers: optional sign and decimal digits. Sets *overflow beyond 32 bits.
const char *ScanInt(const char *begin, const char *end, int *value, bool *overflow);

enum class TokenKind { End, Word, String, Open, Close };

/// A token; its text is valid during the tokenizer's lifetime.
struct Token {
    TokenKind kind = TokenKind::End;
    std::string_view text;  ///< of a string: without quotes, escapes replaced
    uint32_t file = 0;      ///< index into the tokenizer's files
    int line = 0, column = 0;
};

/// Tokens of a file with included files spliced in. Lexical errors are thrown as located UserErrors.
class Tokenizer {
  public:
    /// `outer`: tokenizer of the importing file, for the detection of recursive imports.
    explicit Tokenizer(const Tokenizer *outer = nullptr) : outer_(outer) {}
    Tokenizer(const Tokenizer &) = delete;
    Tokenizer &operator=(const Tokenizer &) = delete;

    /// Reads `file` before continuing with the current one. `key` identifies it for IsOpen.
    void Push(std::shared_ptr<const SourceFile> file, std::string key) {
        PBRT_CHECK(!hasPending_);
        std::string_view text = file->text;
        if (text.starts_with("\xfe\xff") || text.starts_with("\xff\xfe"))
            throw UserError("The file is UTF-16 text; scene files must be UTF-8.", FileLoc{file, 1, 0});
        const char *begin = text.data();
        Reading r{uint32_t(files_.size()), std::move(key), begin, begin + text.size(), begin};
        if (text.starts_with("\xef\xbb\xbf")) r.position += 3;  // UTF-8 byte-order mark
        files_.push_back(std::move(file));
        stack_.push_back(std::move(r));
    }
    /// True if the file is being read here or in an outer tokenizer.
    bool IsOpen(const std::string &key) const {
        auto isIt = [&](const Reading &r) { return r.key == key; };
        return std::any_of(stack_.begin(), stack_.end(), isIt) || (outer_ && outer_->IsOpen(key));
    }
    size_t Depth() const { return stack_.size() + (outer_ ? outer_->Depth() : 0); }

    Token Next() {
        const Token token = hasPending_ ? pending_ : Scan();
        hasPending_ = false;
        if (token.kind != TokenKind::End) last_ = token;
        return token;
    }
    const Token &Peek() {
        if (!hasPending_) {
            pending_ = Scan();
            hasPending_ = pending_.kind != TokenKind::End;
        }
        return pending_;
    }

    /// Bulk reading: appends numbers up to the first token that is not a plain number, the end of a file, or a value
    /// out of range; Next() returns that token. Appends nothing if a peeked token is pending.
    void ReadFloats(std::vector<Float> &out) { ReadNumbers(out, ScanFloat); }
    void ReadInts(std::vector<int> &out) { ReadNumbers(out, ScanInt); }

    FileLoc Loc(const Token &token) const { return {files_[token.file], token.line, token.column}; }
    FileLoc LastLoc() const {
        if (files_.empty()) return {};
        return last_.kind == TokenKind::End ? FileLoc{files_.front(), 0, 0} : Loc(last_);
    }

  private:
    struct Reading {
        uint32_t file;
        std::string key;
        const char *position, *end, *lineBegin;
        int line = 1;
    };
    template <class T, class ScanNumber>
    void ReadNumbers(std::vector<T> &out, ScanNumber scan) {
        if (hasPending_ || stack_.empty()) return;
        Reading &r = stack_.back();
        for (;;) {
            SkipBlanks(r);
            T value{};
            bool overflow = false;
            const char *after = scan(r.position, r.end, &value, &overflow);
            if (after == r.position || overflow || (after != r.end && !EndsWord(*after))) return;
            out.push_back(value);
            r.position = after;
        }
    }
    static void SkipBlanks(Reading &r) {
        const char *p = r.position;
        for (; p != r.end; ++p) {
            char c = *p;
            if (c == '\n') {
                ++r.line;
                r.lineBegin = p + 1;
            } else if (c == '#') {
                while (p != r.end && *p != '\n' && *p != '\r') ++p;
                if (p == r.end) break;
                --p;
            } else if (c != ' ' && c != '\t' && c != '\r') {
                break;
            }
        }
        r.position = p;
    }
    Token Scan() {
        while (!stack_.empty()) {
            Reading &r = stack_.back();
            SkipBlanks(r);
            if (r.position == r.end) {
                stack_.pop_back();
                continue;
            }
            Token token;
            token.file = r.file;
            token.line = r.line;
            token.column = int(r.position - r.lineBegin);
            const char *begin = r.position;
            if (*begin == '"') return ScanString(r, token);
            const char *p = begin + 1;
            if (*begin == '[') {
                token.kind = TokenKind::Open;
            } else if (*begin == ']') {
                token.kind = TokenKind::Close;
            } else {
                token.kind = TokenKind::Word;
                while (p != r.end && !EndsWord(*p)) ++p;
            }
            token.text = std::string_view(begin, p - begin);
            r.position = p;
            return token;
        }
        return {};
    }
    Token ScanString(Reading &r, Token token) {
        token.kind = TokenKind::String;
        const char *quote = r.position, *begin = quote + 1;
        bool escapes = false;
        const char *p = begin;
        for (;; ++p) {
            if (p == r.end || *p == '\n')
                Fail(r, quote, "Unterminated string: the closing quote is missing on this line.");
            if (*p == '"') break;
            if (*p != '\\') continue;
            escapes = true;
            if (p + 1 != r.end && p[1] != '\n') ++p;
        }
        r.position = p + 1;
        token.text = std::string_view(begin, p - begin);
        if (!escapes) return token;
        std::string plain;
        for (const char *c = begin; c != p; ++c) {
            if (*c != '\\') {
                plain += *c;
                continue;
            }
            static constexpr std::string_view kLetters = "bfnrt\\'\"", kMeanings = "\b\f\n\r\t\\'\"";
            size_t which = kLetters.find(*++c);
            if (which == std::string_view::npos)
                Fail(r, c - 1,
                     fmt::format("Unknown escape \"\\{}\" in a string; valid: \\b \\f \\n \\r \\t \\\\ \\' \\\".", *c));
            plain += kMeanings[which];
        }
        token.text = unescaped_.emplace_back(std::move(plain));
        return token;
    }
    [[noreturn]] void Fail(const Reading &r, const char *at, std::string message) const {
        throw UserError(std::move(message), FileLoc{files_[r.file], r.line, int(at - r.lineBegin)});
    }

    const Tokenizer *outer_;
    std::vector<std::shared_ptr<const SourceFile>> files_;
    std::vector<Reading> stack_;
    std::deque<std::string> unescaped_;
    Token pending_, last_;
    bool hasPending_ = false;
};

}  // namespace pbrt
