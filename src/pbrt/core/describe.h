#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/ranges.h>

#include "pbrt/core/params.h"

/// A parameter struct declares each parameter once, with scene-file name, valid values and help; the member's initial
/// value is the default:
///
///   struct OctreeParams {
///       int leaves = 4096;
///       void Describe(auto &&v) { v("leaves", leaves, Range{1, 1 << 20}, "what it does"); }
///   };
///
/// Visitors read it (ParamReader), document it (DocumentParams) and print it (EffectiveParamsText). Parameters are
/// visited in order. One that depends on values of others stands in `if (v.When(condition))` and counts as unused where
/// the condition is false. Between `v.OnlyWith("model", "paper")` and `v.OnlyWith("", "")`, parameters apply only where
/// parameter "model" (text or bool) is "paper"; giving them otherwise is a warning.
///
/// Supported members: int, Float, bool, std::string, std::optional of these, named enumerations, items of several
/// numbers (points, colours), and lists of these. A folder adds types by overloads of ReadParam and DocumentParam,
/// found by argument-dependent lookup. An optional constraint follows the member: a Range, Choices, an array of
/// NamedValue, Items, or Required.
namespace pbrt {

using Choices = std::vector<std::string>;

/// An enumerator with its scene-file name. Describe functions pass a constexpr array of all values of a parameter.
template <class E>
struct NamedValue {
    const char *name;
    E value;
};

/// Values of several numbers each; `type` is their scene-file type. The range applies to each number.
struct Items {
    ParamType type;
    Range<Float> range = AnyFloat();
    bool isRequired = false;  ///< for lists
};

struct Required {};

/// Documentation of one parameter, for listings and for command-line flags.
struct ParamDoc {
    std::string name;
    std::vector<ParamType> types;  ///< alternatives
    bool isList = false;
    std::string defaultValue;  ///< empty if there is none or the help line states it
    std::string range;
    Choices choices;
    std::string help;
    std::string choice, chosen;  ///< applies only where parameter `choice` is `chosen`; empty: always

    std::string TypeText() const;   ///< "integer", "spectrum texture", ...
    std::string ShortType() const;  ///< "i", "st", ...
};

/// Range of valid values for tables: "1 to 10", "above 0", "at least 0 mm".
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
void DocumentParam(ParamDoc &doc, const auto &value, const Choices &choices) {
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
void DocumentParam(ParamDoc &doc, const auto &value, Required) {
    DocumentParam(doc, value);
    doc.defaultValue.clear();
    doc.range = "required";
}

template <class T>
void DocumentParam(ParamDoc &doc, const std::span<const T> &) {
    doc.types = {detail::TypeOf<T>()};
    doc.isList = true;
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
    doc.range = items.isRequired ? "required" : ShortText(items.range);
}
template <class T>
void DocumentParam(ParamDoc &doc, const T &value, const Items &items) {
    doc.types = {items.type};
    doc.range = ShortText(items.range);
    for (int i = 0; i < int(sizeof(T) / sizeof(Float)); ++i)
        doc.defaultValue += fmt::format("{}{}", i ? " " : "", value[i]);
}

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
    template <class T, class Constraint>
    void operator()(const std::string &name, T &value, const Constraint &constraint, const char *help) {
        Add(name, help);
        DocumentParam(docs.back(), value, constraint);
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

/// One row per parameter; the values of `p` are the defaults.
template <class P>
std::vector<ParamDoc> DocumentParams(P p = P()) {
    ParamDocumenter documenter;
    p.Describe(documenter);
    return std::move(documenter.docs);
}

/// For makers without parameters.
struct NoParams {
    void Describe(auto &&) {}
};

}  // namespace pbrt
