#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/ranges.h>

#include "pbrt/core/params.h"

namespace pbrt {

/// The values a text parameter may have.
using Choices = std::vector<std::string>;

/// A parameter struct lists each of its parameters exactly once:
///
///   struct OctreeParams {
///       int leaves = 4096;
///       template <class V> void Describe(V &&v) { v("leaves", leaves, Range{1, 1 << 20}, "what it does"); }
///   };
///
/// A help text that begins with a value of a text parameter and a colon ("paper: ...") says that the parameter has an
/// effect only with that value; giving it with another is a warning.
///
/// The visitors below read it from a scene or from key=value text, print it, and document it. Supported member types:
/// int, Float, bool, and std::string with Choices.
struct ParamDoc {
    std::string name, type, defaultValue, range, help;
};

namespace detail {
template <class T>
constexpr const char *TypeWord() {
    if constexpr (std::is_same_v<T, int>) return "integer";
    else if constexpr (std::is_same_v<T, bool>) return "bool";
    else if constexpr (std::is_same_v<T, std::string>) return "string";
    else return "float";
}
template <class T>
std::string ValueText(T v) {
    if constexpr (std::is_same_v<T, bool>) return v ? "true" : "false";
    else return fmt::format("{}", v);
}
template <class T>
void CheckRange(const ParamSet &set, const std::string &key, T v, Range<T> r) {
    if (!(v >= r.low && v <= r.high))
        throw UserError(fmt::format("\"{}\" is {}; it must be from {} to {}.", key, v, r.low, r.high), set.LocOf(key));
}
}  // namespace detail

/// One row per parameter, with the defaults of a fresh P.
template <class P>
std::vector<ParamDoc> DocumentParams() {
    std::vector<ParamDoc> docs;
    P p;
    auto row = [&](const char *name, auto &value, std::string range, const char *help) {
        using T = std::remove_reference_t<decltype(value)>;
        docs.push_back({name, detail::TypeWord<T>(), detail::ValueText(value), std::move(range), help});
    };
    struct Visitor {
        decltype(row) &emit;
        void operator()(const char *name, int &v, Range<int> r, const char *help) const {
            emit(name, v, fmt::format("{} to {}", r.low, r.high), help);
        }
        void operator()(const char *name, Float &v, Range<Float> r, const char *help) const {
            emit(name, v, fmt::format("{} to {}", r.low, r.high), help);
        }
        void operator()(const char *name, bool &v, const char *help) const { emit(name, v, "", help); }
        void operator()(const char *name, std::string &v, const Choices &choices, const char *help) const {
            emit(name, v, fmt::format("{}", fmt::join(choices, ", ")), help);
        }
    };
    p.Describe(Visitor{row});
    return docs;
}

/// "name value" pairs as they are in force, for metadata and statistics.
template <class P>
nlohmann::ordered_json EffectiveParams(P p) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    struct Visitor {
        nlohmann::ordered_json &json;
        void operator()(const char *name, int &v, Range<int>, const char *) const { json[name] = v; }
        void operator()(const char *name, Float &v, Range<Float>, const char *) const { json[name] = v; }
        void operator()(const char *name, bool &v, const char *) const { json[name] = v; }
        void operator()(const char *name, std::string &v, const Choices &, const char *) const { json[name] = v; }
    };
    p.Describe(Visitor{json});
    return json;
}

/// Reads `prefix`.name parameters from a scene's ParamSet; out-of-range values are located errors.
template <class P>
void ReadParams(P &p, const ParamSet &set, const std::string &prefix) {
    struct Visitor {
        const ParamSet &set;
        const std::string &prefix;
        void operator()(const char *name, int &v, Range<int> r, const char *) const {
            std::string key = prefix + "." + name;
            v = set.GetInt(key, v);
            detail::CheckRange(set, key, v, r);
        }
        void operator()(const char *name, Float &v, Range<Float> r, const char *) const {
            std::string key = prefix + "." + name;
            v = set.GetFloat(key, v);
            detail::CheckRange(set, key, v, r);
        }
        void operator()(const char *name, bool &v, const char *) const { v = set.GetBool(prefix + "." + name, v); }
        void operator()(const char *name, std::string &v, const Choices &choices, const char *) const {
            v = set.GetChoice(prefix + "." + name, v, choices);
        }
    };
    p.Describe(Visitor{set, prefix});
}

/// A function that reads a P and forgets it: for errors before anything is made.
template <class P>
auto ParamsCheck(std::string prefix) {
    return [prefix = std::move(prefix)](const ParamSet &set) {
        P p;
        ReadParams(p, set, prefix);
    };
}

}  // namespace pbrt
