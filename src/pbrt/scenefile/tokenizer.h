#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/float.h"

namespace pbrt {

enum class TokenKind { End, Word, String, Open, Close };

/// A piece of a scene file. The text stays valid while the tokenizer lives.
struct Token {
    TokenKind kind = TokenKind::End;
    std::string_view text;  ///< of a string: without quotes, escapes replaced
    uint32_t file = 0;      ///< index into the tokenizer's files
    int line = 0;
    int column = 0;
};

/// The tokens of a file with other files spliced in (Include): when an inner file ends, the outer one continues.
/// Lexical errors are thrown as located UserErrors.
class Tokenizer {
  public:
    /// `outer`: the tokenizer of the file that imports this one, so that files that import themselves are found.
    explicit Tokenizer(const Tokenizer *outer = nullptr) : outer_(outer) {}
    Tokenizer(const Tokenizer &) = delete;
    Tokenizer &operator=(const Tokenizer &) = delete;

    /// Reads `file` from now on; what was being read continues when it ends. `key` identifies the file for IsOpen.
    void Push(std::shared_ptr<const SourceFile> file, std::string key);
    /// True if that file is being read here or further out.
    bool IsOpen(const std::string &key) const;
    /// How many files are being read, one inside the other, here and further out.
    size_t Depth() const { return stack_.size() + (outer_ ? outer_->Depth() : 0); }

    Token Next();
    const Token &Peek();

    /// Bulk reading: appends the numbers that follow and stops before the first token that is not a plain number, at
    /// the end of a file, or at a value out of range; Next() returns which. Appends nothing if a peeked token is
    /// pending.
    void ReadFloats(std::vector<Float> &out);
    void ReadInts(std::vector<int> &out);

    FileLoc Loc(const Token &token) const { return {files_[token.file], token.line, token.column}; }
    /// Of the token that Next() gave last.
    FileLoc LastLoc() const;

  private:
    struct Reading {
        uint32_t file;
        std::string key;
        const char *position, *end, *lineBegin;
        int line = 1;
    };
    template <class T, class ScanNumber>
    void ReadNumbers(std::vector<T> &out, ScanNumber scan);
    static void SkipBlanks(Reading &r);
    Token Scan();
    Token ScanString(Reading &r, Token token);
    [[noreturn]] void Fail(const Reading &r, const char *at, std::string message) const;

    const Tokenizer *outer_;
    std::vector<std::shared_ptr<const SourceFile>> files_;
    std::vector<Reading> stack_;
    std::deque<std::string> unescaped_;
    Token pending_, last_;
    bool hasPending_ = false;
};

}  // namespace pbrt
