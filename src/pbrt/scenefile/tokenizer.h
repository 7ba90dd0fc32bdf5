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
    int line = 0;
    int column = 0;
};

/// Tokens of a file with included files spliced in. Lexical errors are thrown as located UserErrors.
class Tokenizer {
  public:
    /// `outer`: tokenizer of the importing file, for the detection of recursive imports.
    explicit Tokenizer(const Tokenizer *outer = nullptr) : outer_(outer) {}
    Tokenizer(const Tokenizer &) = delete;
    Tokenizer &operator=(const Tokenizer &) = delete;

    /// Reads `file` before continuing with the current one. `key` identifies it for IsOpen.
    void Push(std::shared_ptr<const SourceFile> file, std::string key);
    /// True if the file is being read here or in an outer tokenizer.
    bool IsOpen(const std::string &key) const;
    size_t Depth() const { return stack_.size() + (outer_ ? outer_->Depth() : 0); }

    Token Next();
    const Token &Peek();

    /// Bulk reading: appends numbers up to the first token that is not a plain number, the end of a file, or a value
    /// out of range; Next() returns that token. Appends nothing if a peeked token is pending.
    void ReadFloats(std::vector<Float> &out);
    void ReadInts(std::vector<int> &out);

    FileLoc Loc(const Token &token) const { return {files_[token.file], token.line, token.column}; }
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
