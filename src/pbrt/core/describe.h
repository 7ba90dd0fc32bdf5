#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/ranges.h>

#include <nlohmann/json_fwd.hpp>

#include "pbrt/core/params.h"

/// A parameter struct lists each of its parameters exactly once, with its name in a scene, what values it may have, and
/// a line of help; the member's initial value is the default:
///
///   struct OctreeParams {
///       int leaves = 4096;
///       template <class V> void Describe(V &&v) { v("leaves", leaves, Range{1, 1 << 20}, "what it does"); }
///   };
///
/// Visitors read it (ParamReader), document it (DocumentParams) and print it (EffectiveParams). Parameters are visited
/// in order, so one that has a meaning only together with the values of others stands in `if (v.When(condition))`:
/// where the condition does not hold, it counts as unused. After `v.OnlyWith("model", "paper")`, and until
/// `v.OnlyWith("", "")`, parameters have an effect only where the text parameter "model" is "paper"; giving them with
/// another value is a warning.
///
/// Members may have further types: a folder adds one by overloads of ReadParam and DocumentParam, which are found by
/// argument-dependent lookup. This file has int, Float, bool, std::string, std::optional of these, enumerations with
/// names, items of several numbers (points, colours ...), and lists of these. After the member may stand a condition on
/// its values: a Range, Choices, an array of NamedValue, Items, or Required.
namespace pbrt {

/// The values a text parameter may have.
using Choices = std::vector<std::string>;

/// A value that scenes refer to by name. Describe functions pass a constexpr array of all values of a parameter.
template <class E>
struct NamedValue {
    const char *name;
    E value;
};

/// Values of several numbers each; `type` is their type in the scene format. Each number must lie in the range.
struct Items {
    ParamType type;
    Range<Float> range = AnyFloat();
};

/// A parameter that has no default.
struct Required {};
struct RequiredItems : Items {};

/// Documentation of one parameter, for listings and for command-line flags.
struct ParamDoc {
    std::string name;
    std::vector<ParamType> types;  ///< a scene may use any of these
    bool isList = false;
    std::string defaultValue;  ///< empty if there is none, or if the help line has it
    std::string range;
    Choices choices;
    std::string help;
    std::string choice, chosen;  ///< has an effect only where the text parameter `choice` is `chosen`; empty: always

    std::string TypeText() const;   ///< "integer", "spectrum texture", ...
    std::string ShortType() const;  ///< "i", "st", ...
};

/// The range of a parameter's values for tables: "1 to 10", "above 0", "at least 0 mm".
template <class T>
std::string ShortText(const Range<T> &r) {
    constexpr T kMax = std::numeric_limits<T>::max();
    const bool hasLow = r.low > std::numeric_limits<T>::lowest(), hasHigh = r.high < kMax;
    std::string text;
    if (!hasLow && !hasHigh) return r.unit;
    if (hasLow && hasHigh && !r.openHigh) text = fmt::format("{}{} to {}", r.openLow ? "above " : "", r.low, r.high);
    else if (hasLow && hasHigh) text = fmt::format("{} {}, below {}", r.openLow ? "above" : "from", r.low, r.high);
    else if (hasLow) text = fmt::format("{} {}", r.openLow ? "above" : "at least", r.low);
    else text = fmt::format("{} {}", r.openHigh ? "below" : "at most", r.high);
    return *r.unit ? text + ' ' + r.unit : text;
}

namespace detail {
template <class T>
constexpr ParamType TypeOf() {
    if constexpr (std::is_same_v<T, int>) return ParamType::Integer;
    else if constexpr (std::is_same_v<T, bool>) return ParamType::Bool;
    else if constexpr (std::is_same_v<T, Float>) return ParamType::Float;
    else {
        static_assert(std::is_same_v<T, std::string>);
        return ParamType::String;
    }
}
template <class T>
std::string ValueText(const T &v) {
    if constexpr (std::is_same_v<T, bool>) return v ? "true" : "false";
    else return fmt::format("{}", v);
}
}  // namespace detail

// Parameters of one of the basic types, with or without a default.

template <class T>
void DocumentParam(ParamDoc &doc, const T &value) {
    doc.types = {detail::TypeOf<T>()};
    doc.defaultValue = detail::ValueText(value);
}
template <class T>
void DocumentParam(ParamDoc &doc, const std::optional<T> &value) {
    doc.types = {detail::TypeOf<T>()};
    if (value) doc.defaultValue = detail::ValueText(*value);
}
template <class T, class U>
void DocumentParam(ParamDoc &doc, const T &value, const Range<U> &range) {
    DocumentParam(doc, value);
    doc.range = ShortText(range);
}
template <class T>
void DocumentParam(ParamDoc &doc, const T &value, const Choices &choices) {
    DocumentParam(doc, value);
    doc.choices = choices;
    doc.range = fmt::format("{}", fmt::join(choices, ", "));
}
template <class E, size_t N>
void DocumentParam(ParamDoc &doc, const E &value, const NamedValue<E> (&values)[N]) {
    doc.types = {ParamType::String};
    for (const NamedValue<E> &v : values) {
        doc.choices.push_back(v.name);
        if (v.value == value) doc.defaultValue = v.name;
    }
    doc.range = fmt::format("{}", fmt::join(doc.choices, ", "));
}
template <class T>
void DocumentParam(ParamDoc &doc, const T &value, Required) {
    DocumentParam(doc, value);
    doc.defaultValue.clear();
    doc.range = "required";
}

// Lists, and items of several numbers.

template <class T>
void DocumentParam(ParamDoc &doc, const std::span<const T> &) {
    doc.types = {detail::TypeOf<T>()};
    doc.isList = true;
}
template <class T>
void DocumentParam(ParamDoc &doc, const std::span<const T> &values, Required) {
    DocumentParam(doc, values);
    doc.range = "required";
}
template <class T, size_t N>
void DocumentParam(ParamDoc &doc, const std::optional<std::array<T, N>> &) {
    DocumentParam(doc, std::span<const T>());
    doc.range = fmt::format("{} values", N);
}
template <class T, size_t N, class U>
void DocumentParam(ParamDoc &doc, const std::optional<std::array<T, N>> &value, const Range<U> &range) {
    DocumentParam(doc, value);
    doc.range += ", each " + ShortText(range);
}
template <class T>
void DocumentParam(ParamDoc &doc, const std::vector<T> &, const Items &items) {
    doc.types = {items.type};
    doc.isList = true;
    doc.range = ShortText(items.range);
}
template <class T>
void DocumentParam(ParamDoc &doc, const std::vector<T> &value, const RequiredItems &items) {
    DocumentParam(doc, value, static_cast<const Items &>(items));
    doc.range = "required";
}
template <class T>
void DocumentParam(ParamDoc &doc, const T &value, const Items &items) {
    doc.types = {items.type};
    doc.range = ShortText(items.range);
    for (int i = 0; i < static_cast<int>(sizeof(T) / sizeof(Float)); ++i)
        doc.defaultValue += fmt::format("{}{}", i ? " " : "", value[i]);
}

/// The visitor that collects the documentation of parameters.
class ParamDocumenter {
  public:
    std::vector<ParamDoc> docs;

    bool When(bool) const { return true; }
    void OnlyWith(std::string choice, std::string chosen) {
        choice_ = std::move(choice);
        chosen_ = std::move(chosen);
    }
    template <class T>
    void operator()(const std::string &name, T &value, const char *help) {
        Add(name, help);
        DocumentParam(docs.back(), value);
    }
    template <class T, class Asked>
    void operator()(const std::string &name, T &value, const Asked &asked, const char *help) {
        Add(name, help);
        DocumentParam(docs.back(), value, asked);
    }

  private:
    void Add(const std::string &name, const char *help) {
        ParamDoc &doc = docs.emplace_back();
        doc.name = name;
        doc.help = help;
        doc.choice = choice_;
        doc.chosen = chosen_;
    }
    std::string choice_, chosen_;
};

/// One row per parameter, with the values of `p` as the defaults.
template <class P>
std::vector<ParamDoc> DocumentParams(P p = P()) {
    ParamDocumenter documenter;
    p.Describe(documenter);
    return std::move(documenter.docs);
}

/// The visitor that writes the values as JSON, see EffectiveParams.
template <class Json>
class ParamPrinter {
  public:
    Json json = Json::object();
    bool When(bool applies) const { return applies; }
    void OnlyWith(const char *, const char *) const {}
    template <class T, class... AskedAndHelp>
    void operator()(const std::string &name, T &value, const AskedAndHelp &...asked) {
        if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            json[name] = value;
        } else {  // the text that would document it as a default
            ParamDocumenter documenter;
            documenter(name, value, asked...);
            json[name] = documenter.docs.front().defaultValue;
        }
    }
};

/// The values in force as a JSON object with a member for each parameter, for metadata and statistics.
template <class P, class Json = nlohmann::ordered_json>
Json EffectiveParams(P p) {
    ParamPrinter<Json> printer;
    p.Describe(printer);
    return std::move(printer.json);
}

/// For makers without parameters.
struct NoParams {
    template <class V>
    void Describe(V &&) {}
};

}  // namespace pbrt
