#include "pbrt/scenefile/tokenizer.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <utility>

namespace pbrt {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool IsHexDigit(char c) { return IsDigit(c) || ((c | 0x20) >= 'a' && (c | 0x20) <= 'f'); }

}  // namespace

const char *ScanFloat(const char *begin, const char *end, Float *value, bool *overflow) {
    const char *p = begin;
    bool negative = false;
    if (p != end && (*p == '-' || *p == '+')) negative = *p++ == '-';
    if (p == end) return begin;
    // from_chars would also accept a second sign, "inf" and "nan".
    if (!IsDigit(*p) && !(*p == '.' && p + 1 != end && IsDigit(p[1]))) return begin;
    auto format = std::chars_format::general;
    const char *digits = p;
    if (*p == '0' && end - p >= 3 && (p[1] | 0x20) == 'x' && (IsHexDigit(p[2]) || p[2] == '.')) {
        format = std::chars_format::hex;
        digits = p + 2;
    }
    Float magnitude = 0;
    auto [after, error] = std::from_chars(digits, end, magnitude, format);
    if (error == std::errc::invalid_argument) return begin;
    if (error == std::errc::result_out_of_range) {
        magnitude = std::strtof(std::string(p, after).c_str(), nullptr);
        if (magnitude > 1) {
            *overflow = true;
            return after;
        }
    }
    *value = negative ? -magnitude : magnitude;
    return after;
}

const char *ScanInt(const char *begin, const char *end, int *value, bool *overflow) {
    const char *p = begin;
    if (p != end && (*p == '+' || *p == '-')) ++p;
    if (p == end || !IsDigit(*p)) return begin;
    auto [after, error] = std::from_chars(*begin == '+' ? p : begin, end, *value);
    if (error == std::errc::result_out_of_range) *overflow = true;
    return after;
}

void Tokenizer::Push(std::shared_ptr<const SourceFile> file, std::string key) {
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

bool Tokenizer::IsOpen(const std::string &key) const {
    auto isIt = [&](const Reading &r) { return r.key == key; };
    return std::any_of(stack_.begin(), stack_.end(), isIt) || (outer_ && outer_->IsOpen(key));
}

Token Tokenizer::Next() {
    const Token token = hasPending_ ? pending_ : Scan();
    hasPending_ = false;
    if (token.kind != TokenKind::End) last_ = token;
    return token;
}

const Token &Tokenizer::Peek() {
    if (!hasPending_) {
        pending_ = Scan();
        hasPending_ = pending_.kind != TokenKind::End;
    }
    return pending_;
}

FileLoc Tokenizer::LastLoc() const {
    if (files_.empty()) return {};
    if (last_.kind == TokenKind::End) return {files_.front(), 0, 0};
    return Loc(last_);
}

void Tokenizer::SkipBlanks(Reading &r) {
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

Token Tokenizer::Scan() {
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

Token Tokenizer::ScanString(Reading &r, Token token) {
    token.kind = TokenKind::String;
    const char *quote = r.position, *begin = quote + 1;
    bool escapes = false;
    const char *p = begin;
    for (;; ++p) {
        if (p == r.end || *p == '\n') Fail(r, quote, "Unterminated string: the closing quote is missing on this line.");
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

void Tokenizer::Fail(const Reading &r, const char *at, std::string message) const {
    throw UserError(std::move(message), FileLoc{files_[r.file], r.line, int(at - r.lineBegin)});
}

template <class T, class ScanNumber>
void Tokenizer::ReadNumbers(std::vector<T> &out, ScanNumber scan) {
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

void Tokenizer::ReadFloats(std::vector<Float> &out) { ReadNumbers(out, ScanFloat); }
void Tokenizer::ReadInts(std::vector<int> &out) { ReadNumbers(out, ScanInt); }

}  // namespace pbrt
