#pragma once

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/version.h"

namespace pbrt {

/// Finite numbers that a flag takes. Integers must also fit their type.
struct ValidRange {
    static constexpr double kMax = std::numeric_limits<double>::max();
    double low = -kMax, high = kMax;
    bool openLow = false;
};
inline constexpr ValidRange PositiveNumber{.low = 0, .openLow = true}, NonNegativeNumber{.low = 0};

/// Reads a number after dropping leading zeros, which mean octal integers to CLI11.
template <class T>
bool ReadNumber(std::string &text, T &value) {
    const size_t first = text.find_first_not_of("+-");
    while (first < text.size() && text[first] == '0' && std::isdigit(static_cast<unsigned char>(text[first + 1])))
        text.erase(first, 1);
    return CLI::detail::lexical_cast(text, value);
}

/// Validator of numbers of type T; drops leading zeros. CLI11's accept NaN, or print the largest double as a bound.
template <class T>
CLI::Validator NumberCheck(ValidRange range) {
    const std::string name = range.high < ValidRange::kMax      ? fmt::format("[{:g}, {:g}]", range.low, range.high)
                             : !(range.low > -ValidRange::kMax) ? ""
                             : range.openLow                    ? "POSITIVE"
                                                                : "NONNEGATIVE";
    constexpr bool isInteger = std::is_integral_v<T>;
    if constexpr (isInteger) {
        range.low = std::max(range.low + range.openLow, double(std::numeric_limits<T>::lowest()));
        range.high = std::min(range.high, double(std::numeric_limits<T>::max()));
        range.openLow = false;
    }
    const std::string valid =
        range.high < ValidRange::kMax
            ? fmt::format("{} from {:.10g} to {:.10g}", isInteger ? "an integer" : "a number", range.low, range.high)
        : range.low > -ValidRange::kMax
            ? fmt::format("a finite number {} {}", range.openLow ? "above" : "from", range.low)
            : "a finite number";
    return CLI::Validator(
        [range, valid](std::string &text) {
            T value{};
            const bool isNumber = ReadNumber(text, value);
            const auto v = double(value);
            const bool isValid = isNumber && v <= range.high && (range.openLow ? v > range.low : v >= range.low);
            return isValid ? "" : fmt::format("\"{}\" is not {}", text, valid);
        },
        name);
}

/// Validator of names. An error suggests the nearest.
inline CLI::Validator OneOf(const std::vector<std::string> &names) {
    return CLI::Validator(
        [names](std::string &text) {
            return std::ranges::count(names, text) > 0
                       ? ""
                       : fmt::format("\"{}\" is unknown; {}", text, ListChoices(text, names));
        },
        fmt::format("{{{}}}", fmt::join(names, ",")));
}

/// Type of one value of a flag's target: T, or what an optional or a list holds.
template <class T>
struct FlagValue {
    using Type = T;
};
template <class T>
struct FlagValue<std::optional<T>> : FlagValue<T> {};
template <class T>
struct FlagValue<std::vector<T>> : FlagValue<T> {};

/// Row of a flag table: names as CLI11 declares them, target, help text, valid numbers or validator. A bool takes no
/// value; lists of flags are comma-separated. Numbers must be finite, texts not empty.
class Flag {
  public:
    template <class T>
    Flag(std::string names, T &target, std::string help, ValidRange range = {})
        : Flag(std::move(names), target, std::move(help), [&] {
              if constexpr (std::is_same_v<T, bool>) return CLI::Validator("");
              else if constexpr (std::is_arithmetic_v<typename FlagValue<T>::Type>)
                  return NumberCheck<typename FlagValue<T>::Type>(range);
              else
                  return CLI::Validator([](std::string &text) { return text.empty() ? "the value is empty" : ""; }, "");
          }()) {}
    template <class T>
    Flag(std::string names, T &target, std::string help, CLI::Validator check)
        : add_([=, &target](CLI::App &app) {
              CLI::Option *option = nullptr;
              if constexpr (std::is_same_v<T, bool>) option = app.add_flag(names, target, help);
              else option = app.add_option(names, target, help);
              if constexpr (CLI::detail::is_mutable_container<T>::value)
                  if (names[0] == '-') option->delimiter(',')->allow_extra_args(false);
              return option->transform(check);
          }) {}
    Flag &&Type(const char *name) && {
        type_ = name;
        return std::move(*this);
    }
    /// Number of values of a list.
    Flag &&Count(int count) && {
        count_ = count;
        return std::move(*this);
    }
    Flag &&Required() && {
        isRequired_ = true;
        return std::move(*this);
    }
    /// Shows the target's value as the default in the help text.
    Flag &&ShowDefault() && {
        showsDefault_ = true;
        return std::move(*this);
    }
    CLI::Option *AddTo(CLI::App &app) const {
        CLI::Option *option = add_(app)->required(isRequired_);
        if (type_) option->type_name(type_);
        if (count_ > 0) option->expected(count_);
        return showsDefault_ ? option->capture_default_str() : option;
    }

  private:
    const char *type_ = nullptr;
    int count_ = 0;
    bool isRequired_ = false, showsDefault_ = false;
    std::function<CLI::Option *(CLI::App &)> add_;
};

/// Adds a table of flags under a heading of the help text.
inline void AddFlags(CLI::App &app, const std::string &heading, std::initializer_list<Flag> rows) {
    for (const Flag &row : rows) row.AddTo(app)->group(heading);
}
inline void AddFlags(CLI::App &app, std::initializer_list<Flag> rows) { AddFlags(app, "Options", rows); }

/// Row of a table of flags that are valid only with, or only without, another flag.
struct FlagRule {
    const char *flag;
    enum Kind { Needs, Excludes } kind;
    const char *other, *reason;
};

/// Throws CLI::ValidationError for the first broken rule of the parsed flags.
inline void CheckRules(const CLI::App &app, std::initializer_list<FlagRule> rules) {
    const auto isGiven = [&](const char *name) {
        const CLI::Option &option = *app.get_option(name);
        return option.count() > 0 && (option.get_expected_max() > 0 || option.as<bool>());
    };
    for (const auto &[flag, kind, other, reason] : rules)
        if (isGiven(flag) && isGiven(other) == (kind == FlagRule::Excludes))
            throw CLI::ValidationError(fmt::format("{} {} {}{}: {}", flag, kind == FlagRule::Needs ? "needs" : "and",
                                                   other, kind == FlagRule::Needs ? "" : " exclude each other",
                                                   reason));
}

/// Replacements for flags of other programs, keyed by folded name (FoldFlag).
using FlagHints = std::map<std::string, std::string>;

/// Flag name in lower case without - and _, for comparison.
inline std::string FoldFlag(std::string name) {
    std::erase_if(name, [](char c) { return c == '-' || c == '_'; });
    return CLI::detail::to_lower(name);
}

/// True for -x, --xyz and --xyz=value, but not for numbers, "-" and "--".
inline bool IsFlag(const std::string &argument) {
    const size_t name = argument.find_first_not_of('-');
    return (name == 1 || name == 2) && !std::isdigit(static_cast<unsigned char>(argument[name])) &&
           argument[name] != '.';
}

/// The argument with its flag in the declared spelling of `app`. Unknown flags and other arguments stay unchanged.
inline std::string CanonicalFlag(const CLI::App &app, const std::string &argument) {
    if (!IsFlag(argument)) return argument;
    const size_t equals = std::min(argument.find('='), argument.size());
    const std::string folded = FoldFlag(argument.substr(0, equals));
    for (const CLI::Option *option : app.get_options())
        for (const std::string &name : option->get_lnames())
            if (FoldFlag(name) == folded) return "--" + name + argument.substr(equals);
    return argument;
}

/// Throws if a number list has the wrong length. CLI11 would count any words that follow.
inline void CheckNumberList(const CLI::Option &option, const std::vector<std::string> &arguments, size_t at) {
    const int wanted = option.get_expected_min() * option.get_type_size_min();
    const size_t equals = arguments[at].find('=');
    std::string given;
    int count = 0;
    for (size_t i = at; i < arguments.size() && count < wanted; ++i) {
        if (i == at && equals == std::string::npos) continue;
        for (const std::string &word :
             CLI::detail::split(i == at ? arguments[i].substr(equals + 1) : arguments[i], ',')) {
            double number = 0;
            if (!CLI::detail::lexical_cast(word, number))
                throw CLI::ValidationError(fmt::format("{} takes {} numbers, {}: \"{}\" is not a number",
                                                       option.get_name(), wanted, option.get_type_name(), word));
            given += (count++ ? " " : "") + word;
        }
    }
    if (count != wanted)
        throw CLI::ValidationError(fmt::format("{} takes {} numbers, {}, but has {}{}{}", option.get_name(), wanted,
                                               option.get_type_name(), count, count ? ": " : "", given));
}

/// Throws CLI::ValidationError for the first unknown flag, suggesting the closest one, and for number lists of wrong
/// length. Call before CLI11 parses: it would report the first leftover word, which may be a misspelt flag's value or a
/// file.
inline void CheckFlags(const CLI::App &app, const std::vector<std::string> &arguments, const FlagHints &hints = {}) {
    for (size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
        if (!IsFlag(arguments[i])) continue;
        const std::string flag = arguments[i].substr(0, arguments[i].find('='));
        if (const CLI::Option *option = app.get_option_no_throw(flag)) {
            if (arguments[i] == flag + "=")
                throw CLI::ValidationError(fmt::format("{}: the value after = is missing", flag));
            if (option->get_expected_min() > 1) CheckNumberList(*option, arguments, i);
            if (option->get_expected_max() == 1 && option->get_type_size() == 1 && flag == arguments[i])
                ++i;  // its value
            continue;
        }
        const std::string name = CLI::detail::to_lower(flag.substr(flag.find_first_not_of('-')));
        if (const auto hint = hints.find(FoldFlag(flag)); hint != hints.end())
            throw CLI::ValidationError(fmt::format("{}: {}", flag, hint->second));
        std::vector<std::string> names;
        for (const CLI::Option *option : app.get_options())
            for (const std::string &known : option->get_lnames()) names.push_back(known);
        const std::string nearest = NearestChoice(name, names);
        throw CLI::ValidationError(fmt::format("unknown flag {}{}", flag,
                                               nearest.empty() ? "" : fmt::format("; did you mean --{}?", nearest)));
    }
}

/// The error in plain words.
inline std::string MessageOf(const CLI::ParseError &e) {
    const std::string text = e.what(), unconverted = "Could not convert: ";
    if (text.starts_with(unconverted)) return text.substr(unconverted.size()) + " is neither true nor false";
    const size_t count = text.find(": At Most ");
    return count == std::string::npos ? text : text.substr(0, count) + ": is given more than once";
}

/// Parses the arguments without the program name, then calls `check`, which may throw CLI::ParseError. After printing
/// help, version or an error, returns the exit status.
std::optional<int> ParseFlags(CLI::App &app, std::vector<std::string> arguments, const FlagHints &hints, auto &&check) {
    try {
        CheckFlags(app, arguments, hints);
        std::reverse(arguments.begin(), arguments.end());  // CLI11 expects reverse order
        app.parse(arguments);
        check();
        return {};
    } catch (const CLI::CallForHelp &) {
        std::cout << app.help();
        return 0;
    } catch (const CLI::CallForVersion &) {
        std::cout << VersionText() << "\n";
        return 0;
    } catch (const CLI::ParseError &e) {
        std::cerr << "Error: " << MessageOf(e) << "\nRun with --help for all options.\n";
        return 1;
    }
}

/// The command line as typed, joined by blanks.
inline std::string JoinArguments(int argc, const char *const *argv) {
    return fmt::format("{}", fmt::join(argv, argv + argc, " "));
}

}  // namespace pbrt
