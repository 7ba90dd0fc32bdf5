#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/scenefile/tokenizer.h"

namespace pbrt {

/// Offset of the first byte of invalid UTF-8 (also overlong forms, surrogates, beyond U+10FFFF); nullopt if valid.
std::optional<size_t> FindInvalidUtf8(std::string_view text);

/// Unicode normalisation form C, for names with combining marks. Returns invalid UTF-8 unchanged.
std::string ComposeUtf8(std::string_view text);

/// Reads arguments and parameter lists. Recoverable errors (an unknown type, values of the wrong kind) go to the sink;
/// others are thrown as a located UserError.
class ParameterReader {
  public:
    ParameterReader(Tokenizer &tokens, DiagnosticSink &sink) : tokens_(tokens), sink_(sink) {}

    /// Reads parameters up to the first token that is not a quoted string.
    std::vector<Param> ReadList(const std::string &colorSpace) {
        std::vector<Param> list;
        while (tokens_.Peek().kind == TokenKind::String) {
            Token declaration = tokens_.Next();
            bool known = true;
            Param param = ReadDeclaration(declaration, &known);
            Values values;
            ReadValues(param, known, values);
            if (!known) continue;
            CheckKind(param, values);
            param.colorSpace = colorSpace;
            param.strings = std::move(values.strings);
            param.bools = std::move(values.bools);
            param.ints.assign(ints_.begin(), ints_.end());
            param.floats.assign(floats_.begin(), floats_.end());
            list.push_back(std::move(param));
        }
        WarnOfRepeated(list);
        return list;
    }

    /// Reads a required argument; `what` names it in messages.
    Token ReadString(const char *what) {
        Token token = Require(what);
        if (token.kind != TokenKind::String) Fail(token, "Expected {} in quotes, found {}.", what, Quote(token));
        return token;
    }
    Token ReadWord(const char *what) {
        Token token = Require(what);
        if (token.kind != TokenKind::Word) Fail(token, "Expected {}, found {}.", what, Quote(token));
        return token;
    }
    Float ReadFloat(const char *what) { return ReadNumber<Float>(what, ScanFloat, ParamType::Float, "a number"); }
    int ReadInt(const char *what) {
        return ReadNumber<int>(what, ScanInt, ParamType::Integer, fmt::format("{} (an integer)", what));
    }
    bool ReadBool(const char *what) {
        Token token = Require(what);
        if (token.kind == TokenKind::Word && token.text == "true") return true;
        if (token.kind == TokenKind::Word && token.text == "false") return false;
        Fail(token, "Expected {}: true or false without quotes, found {}.", what, Quote(token));
    }

    /// The string as a name in composed form (NFC); throws if it is not valid UTF-8.
    std::string NameOf(const Token &token) const {
        if (auto bad = FindInvalidUtf8(token.text))
            Fail(token, "The name \"{}\\x{:02x}...\" is not valid UTF-8.", Abbreviate(token.text.substr(0, *bad)),
                 static_cast<unsigned char>(token.text[*bad]));
        return ComposeUtf8(token.text);
    }

    /// Next token; throws at the end of the input, naming `what` was expected.
    Token Require(const char *what) {
        Token token = tokens_.Next();
        if (token.kind == TokenKind::End)
            throw UserError(tokens_.LastLoc(), "Premature end of file: after this, {} is expected.", what);
        return token;
    }
    [[noreturn]] void Fail(const Token &token, std::string message) const {
        throw UserError(std::move(message), tokens_.Loc(token));
    }
    template <class... T>
    [[noreturn]] void Fail(const Token &token, fmt::format_string<T...> format, T &&...values) const {
        Fail(token, fmt::format(format, std::forward<T>(values)...));
    }

  private:
    enum class Kind { None, Number, String, Bool };
    /// Values of the parameter being read. Numbers are in floats_ or ints_.
    struct Values {
        Kind kind = Kind::None;
        Token first;
        std::vector<std::string> strings;
        std::vector<uint8_t> bools;
    };
    Param ReadDeclaration(const Token &token, bool *known) {
        std::string_view text = token.text;
        std::string_view typeWord = TakeWord(text), name = TakeWord(text);
        if (typeWord.empty() || name.empty())
            Fail(token, "Expected a parameter declaration \"type name\", found \"{}\".", Abbreviate(token.text));
        Param param;
        param.loc = tokens_.Loc(token);
        param.name = name;
        const auto type = std::find(kParamTypeNames.begin(), kParamTypeNames.end(), typeWord);
        *known = type != kParamTypeNames.end();
        if (*known) param.type = static_cast<ParamType>(type - kParamTypeNames.begin());
        else
            sink_.Error(param.loc, "\"{}\": unknown parameter type \"{}\"; {}{}.", Abbreviate(token.text),
                        Abbreviate(typeWord), OldNameHint("parameter type", typeWord),
                        ListChoices(typeWord, {kParamTypeNames.begin(), kParamTypeNames.end()}));
        return param;
    }
    void WarnOfRepeated(const std::vector<Param> &list) {
        if (list.size() < 2) return;
        std::vector<const Param *> sorted;
        for (const Param &p : list) sorted.push_back(&p);
        const auto key = [](const Param *p) { return std::tie(p->name, p->type); };
        std::ranges::stable_sort(sorted, {}, key);
        for (size_t i = 1; i < sorted.size(); ++i)
            if (const Param &p = *sorted[i], &before = *sorted[i - 1]; key(&p) == key(&before))
                sink_.Warning(p.loc, "\"{} {}\" replaces the one given at {}:{}:{}.", Name(p.type), Abbreviate(p.name),
                              before.loc.file->name, before.loc.line, before.loc.column);
    }
    void ReadValues(const Param &param, bool known, Values &values) {
        floats_.clear();
        ints_.clear();
        bool asInteger = known && param.type == ParamType::Integer;
        bool takesNumbers = !known || (!TakesStrings(param.type) && param.type != ParamType::Bool);
        Token token = Require("a value");
        bool bracketed = token.kind == TokenKind::Open;
        do {
            if (bracketed) {
                if (takesNumbers && (values.kind == Kind::None || values.kind == Kind::Number)) {
                    if (asInteger) tokens_.ReadInts(ints_);
                    else tokens_.ReadFloats(floats_);
                    if (values.kind == Kind::None && !(ints_.empty() && floats_.empty())) {
                        values.kind = Kind::Number;
                        values.first = token;
                    }
                }
                token = Require("] or a value");
                if (token.kind == TokenKind::Close) return;
            }
            if (token.kind == TokenKind::Open) Fail(token, "There is a [ inside a bracketed list.");
            if (token.kind == TokenKind::Close) Fail(token, "There is a ] without [ before it.");
            Kind kind = ReadValue(token, param, known, bracketed, values);
            if (values.kind == Kind::None) {
                values.kind = kind;
                values.first = token;
            } else if (values.kind != kind) {
                Fail(token,
                     "{} among other kinds of values of \"{}\": all must be numbers, all strings or all true/false.",
                     Quote(token), Abbreviate(param.name));
            }
        } while (bracketed);
    }
    Kind ReadValue(const Token &token, const Param &param, bool known, bool bracketed, Values &values) {
        if (token.kind == TokenKind::String) {
            values.strings.push_back(known && HoldsNames(param) ? NameOf(token) : std::string(token.text));
            return Kind::String;
        }
        if (token.text == "true" || token.text == "false") {
            values.bools.push_back(token.text == "true");
            return Kind::Bool;
        }
        const char *begin = token.text.data(), *end = begin + token.text.size();
        Float number = 0;
        bool overflow = false;
        if (ScanFloat(begin, end, &number, &overflow) != end)
            Fail(token, "Expected {} for \"{}\", found {}{}.", known ? ExpectedValues(param.type) : "a value",
                 Abbreviate(param.name), Quote(token), bracketed ? "; is ] missing before it?" : "");
        if (!known || param.type != ParamType::Integer) {
            if (overflow) ReportOverflow(token, ParamType::Float);
            floats_.push_back(number);
            return Kind::Number;
        }
        int integer = 0;
        overflow = false;
        if (ScanInt(begin, end, &integer, &overflow) != end)
            sink_.Error(tokens_.Loc(token), "Expected an integer for \"{}\", found {}.", Abbreviate(param.name),
                        Abbreviate(token.text));
        else if (overflow) ReportOverflow(token, ParamType::Integer);
        ints_.push_back(integer);
        return Kind::Number;
    }
    void CheckKind(const Param &param, const Values &values) {
        if (values.kind == Kind::None) return;
        bool fits = values.kind == Kind::Number;
        if (TakesStrings(param.type)) fits = values.kind == Kind::String;
        if (param.type == ParamType::Bool) fits = values.kind == Kind::Bool;
        if (param.type == ParamType::Spectrum) fits = values.kind != Kind::Bool;
        if (!fits)
            sink_.Error(tokens_.Loc(values.first), "\"{} {}\" takes {}, found {}.", Name(param.type),
                        Abbreviate(param.name), ExpectedValues(param.type), Quote(values.first));
    }
    /// `scan`: ScanFloat or ScanInt.
    template <class T, class Scan>
    T ReadNumber(const char *what, Scan scan, ParamType type, const std::string &expected) {
        const Token token = Require(what);
        T value = 0;
        bool overflow = false;
        const char *end = token.text.data() + token.text.size();
        if (token.kind != TokenKind::Word || scan(token.text.data(), end, &value, &overflow) != end)
            Fail(token, "Expected {}, found {}.", expected, Quote(token));
        if (overflow) ReportOverflow(token, type);
        return value;
    }
    /// The caller substitutes 0 and continues, so that one run reports all such numbers.
    void ReportOverflow(const Token &token, ParamType type) const {
        std::string rule = "a number must lie between -3.4028235e+38 and 3.4028235e+38 (32-bit float)";
        if (type == ParamType::Integer)
            rule = "it does not fit a 32-bit integer, which lies between -2147483648 and 2147483647";
        sink_.Error(tokens_.Loc(token), "{} is too large: {}.", Abbreviate(token.text), rule);
    }

    static std::string_view TakeWord(std::string_view &text) {
        size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
        size_t end = std::min(text.find_first_of(" \t", begin), text.size());
        std::string_view word = text.substr(begin, end - begin);
        text.remove_prefix(end);
        return word;
    }
    static bool TakesStrings(ParamType type) { return type == ParamType::String || type == ParamType::Texture; }
    /// True if the strings name entities, which are compared in composed form (NFC).
    static bool HoldsNames(const Param &param) { return param.type == ParamType::Texture || param.name == "materials"; }
    static const char *ExpectedValues(ParamType type) {
        if (TakesStrings(type)) return "quoted strings";
        if (type == ParamType::Bool) return "true or false (without quotes)";
        return type == ParamType::Spectrum ? "numbers or quoted names" : "numbers";
    }
    static std::string Quote(const Token &token) {
        return fmt::format("{}\"{}\"", token.kind == TokenKind::String ? "the string " : "", Abbreviate(token.text));
    }

    Tokenizer &tokens_;
    DiagnosticSink &sink_;
    std::vector<Float> floats_;  // reused between parameters
    std::vector<int> ints_;
};

}  // namespace pbrt
