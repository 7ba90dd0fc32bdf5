#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/scenefile/tokenizer.h"

namespace pbrt {

/// Reads arguments and parameter lists. Recoverable errors (an unknown type, values of the wrong kind) go to the sink;
/// others are thrown as a located UserError.
class ParameterReader {
  public:
    ParameterReader(Tokenizer &tokens, DiagnosticSink &sink) : tokens_(tokens), sink_(sink) {}

    /// Reads parameters up to the first token that is not a quoted string.
    std::vector<Param> ReadList(const std::string &colorSpace);

    /// Reads a required argument; `what` names it in messages.
    Token ReadString(const char *what);
    Token ReadWord(const char *what);
    Float ReadFloat(const char *what);
    int ReadInt(const char *what);
    bool ReadBool(const char *what);

    /// The string as a name in composed form (NFC); throws if it is not valid UTF-8.
    std::string NameOf(const Token &token) const;

    /// Next token; throws at the end of the input, naming `what` was expected.
    Token Require(const char *what);
    [[noreturn]] void Fail(const Token &token, std::string message) const;
    template <class... T>
    [[noreturn]] void Fail(const Token &token, fmt::format_string<T...> format, T &&...values) const {
        Fail(token, fmt::format(format, std::forward<T>(values)...));
    }

  private:
    enum class Kind { None, Number, String, Bool };
    struct Values;
    Param ReadDeclaration(const Token &token, bool *known);
    void ReadValues(const Param &param, bool known, Values &values);
    Kind ReadValue(const Token &token, const Param &param, bool known, bool bracketed, Values &values);
    void CheckKind(const Param &param, const Values &values);
    /// `scan`: ScanFloat or ScanInt.
    template <class T, class Scan>
    T ReadNumber(const char *what, Scan scan, ParamType type, const std::string &expected);
    void ReportOverflow(const Token &token, ParamType type) const;

    Tokenizer &tokens_;
    DiagnosticSink &sink_;
    std::vector<Float> floats_;  // reused between parameters
    std::vector<int> ints_;
};

/// Offset of the first byte of invalid UTF-8 (including overlong forms, surrogates and values beyond U+10FFFF); nullopt
/// if valid.
std::optional<size_t> FindInvalidUtf8(std::string_view text);

/// Unicode normalisation form C, so that names with combining marks equal precomposed ones. Returns invalid UTF-8
/// unchanged.
std::string ComposeUtf8(std::string_view text);

}  // namespace pbrt
