#pragma once
#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "pbrt/core/describe.h"

namespace pbrt {

/// Reads a parameter struct from a ParamSet: `p.Describe(reader); reader.Finish(sink);`. It remembers what was declared,
/// so that whatever else the set has is found. Attribute defaults are never reported.
class ParamReader {
  public:
    /// The names in the set begin with `prefix`.
    explicit ParamReader(const ParamSet &set, std::string prefix = {}) : set_(set), prefix_(std::move(prefix)) {}
    /// Goes on where another reader of the same set ends: what was declared there is known here.
    ParamReader(const ParamSet &set, const ParamReader &other) : set_(set), declared_(other.declared_) {}

    bool When(bool applies) const { return applies; }
    template <class T>
    void operator()(const std::string &name, T &value, const char *) {
        Collect([&] { ReadParam(*this, prefix_ + name, value); });
    }
    template <class T, class Asked>
    void operator()(const std::string &name, T &value, const Asked &asked, const char *) {
        Collect([&] { ReadParam(*this, prefix_ + name, value, asked); });
    }

    /// What is in the set but was not declared, or with another type, goes to the sink. Throws one UserError with
    /// everything that is wrong with the values.
    void Finish(DiagnosticSink &sink) const {
        ReportUnused(sink);
        ThrowIfErrors();
    }
    void ThrowIfErrors() const {
        if (!errors_.empty()) throw UserError(errors_);
    }

    // For overloads of ReadParam.

    const ParamSet &Set() const { return set_; }
    /// The parameter of that name and type; null if it is absent.
    const Param *Take(const std::string &name, ParamType type) {
        Declare(name, type);
        return set_.Find(name, type);
    }
    /// A parameter of that name and type may be there.
    void Declare(const std::string &name, ParamType type) { declared_.push_back({name, type}); }

  private:
    struct Declared {
        std::string name;
        ParamType type;
    };
    template <class F>
    void Collect(F &&read) {
        try {
            read();
        } catch (const UserError &e) {
            errors_.insert(errors_.end(), e.Diagnostics().begin(), e.Diagnostics().end());
        }
    }
    void ReportUnused(DiagnosticSink &sink) const;

    const ParamSet &set_;
    std::string prefix_;
    std::vector<Declared> declared_;
    std::vector<Diagnostic> errors_;
};

namespace detail {
template <class T>
const auto &ValuesOf(const Param &p) {
    if constexpr (std::is_same_v<T, int>) return p.ints;
    else if constexpr (std::is_same_v<T, bool>) return p.bools;
    else if constexpr (std::is_same_v<T, std::string>) return p.strings;
    else return p.floats;
}
/// A UserError unless the parameter has that many numbers (or texts).
void RequireCount(const ParamSet &set, const Param &p, size_t found, size_t wanted);
void RequireItems(const ParamSet &set, const Param &p);
[[noreturn]] void ThrowMissing(const ParamSet &set, const std::string &name, ParamType type);
[[noreturn]] void ThrowNoChoice(const ParamSet &set, const std::string &name, const std::string &given,
                                const Choices &choices);
}  // namespace detail

/// The single value of a parameter; null if it is absent. (Of a bool: its byte.)
template <class T>
const auto *TakeOne(ParamReader &reader, const std::string &name) {
    const Param *p = reader.Take(name, detail::TypeOf<T>());
    if (!p) return static_cast<decltype(detail::ValuesOf<T>(*p).data())>(nullptr);
    const auto &values = detail::ValuesOf<T>(*p);
    detail::RequireCount(reader.Set(), *p, values.size(), 1);
    return values.data();
}

template <class T>
void ReadParam(ParamReader &reader, const std::string &name, T &value) {
    if (const auto *given = TakeOne<T>(reader, name)) value = *given;
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::optional<T> &value) {
    if (const auto *given = TakeOne<T>(reader, name)) value = *given;
}
template <class T, class U>
void ReadParam(ParamReader &reader, const std::string &name, T &value, const Range<U> &range) {
    if (const U *given = TakeOne<U>(reader, name)) {
        reader.Set().Require(name, *given, range);
        value = *given;
    }
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, T &value, const Choices &choices) {
    if (const std::string *given = TakeOne<std::string>(reader, name)) {
        if (std::find(choices.begin(), choices.end(), *given) == choices.end())
            detail::ThrowNoChoice(reader.Set(), name, *given, choices);
        value = *given;
    }
}
template <class E, size_t N>
void ReadParam(ParamReader &reader, const std::string &name, E &value, const NamedValue<E> (&values)[N]) {
    const std::string *given = TakeOne<std::string>(reader, name);
    if (!given) return;
    Choices names;
    for (const NamedValue<E> &v : values) {
        if (*given == v.name) {
            value = v.value;
            return;
        }
        names.push_back(v.name);
    }
    detail::ThrowNoChoice(reader.Set(), name, *given, names);
}
inline void ReadParam(ParamReader &reader, const std::string &name, std::string &value, Required) {
    ReadParam(reader, name, value);
    if (value.empty()) detail::ThrowMissing(reader.Set(), name, ParamType::String);
}

/// The values stay where they are, in the set.
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::span<const T> &values) {
    if (const Param *p = reader.Take(name, detail::TypeOf<T>())) values = detail::ValuesOf<T>(*p);
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::span<const T> &values, Required) {
    ReadParam(reader, name, values);
    if (values.empty()) detail::ThrowMissing(reader.Set(), name, detail::TypeOf<T>());
}
template <class T, size_t N>
void ReadParam(ParamReader &reader, const std::string &name, std::optional<std::array<T, N>> &values) {
    const Param *p = reader.Take(name, detail::TypeOf<T>());
    if (!p) return;
    const auto &given = detail::ValuesOf<T>(*p);
    detail::RequireCount(reader.Set(), *p, given.size(), N);
    std::copy(given.begin(), given.end(), values.emplace().begin());
}
template <class T, size_t N, class U>
void ReadParam(ParamReader &reader, const std::string &name, std::optional<std::array<T, N>> &values,
               const Range<U> &range) {
    ReadParam(reader, name, values);
    if (values)
        for (T v : *values) reader.Set().Require(name, v, range);
}

/// Items are copied number by number: T is a point, a colour ...
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::vector<T> &values, const Items &items) {
    static_assert(std::is_trivially_copyable_v<T>);
    PBRT_DCHECK(sizeof(T) == ItemSize(items.type) * sizeof(Float));
    const Param *p = reader.Take(name, items.type);
    if (!p) return;
    detail::RequireItems(reader.Set(), *p);
    if (items.range.low > AnyFloat().low)
        for (Float v : p->floats) reader.Set().Require(name, v, items.range);
    values.resize(p->floats.size() * sizeof(Float) / sizeof(T));
    if (!values.empty()) std::memcpy(static_cast<void *>(values.data()), p->floats.data(), values.size() * sizeof(T));
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::vector<T> &values, const RequiredItems &items) {
    ReadParam(reader, name, values, static_cast<const Items &>(items));
    if (values.empty()) detail::ThrowMissing(reader.Set(), name, items.type);
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, T &value, const Items &items) {
    std::vector<T> values;
    ReadParam(reader, name, values, items);
    const Param *p = reader.Set().Find(name, items.type);
    if (!p) return;
    detail::RequireCount(reader.Set(), *p, p->floats.size(), ItemSize(items.type));
    value = values[0];
}

/// A parameter struct. What P does not know goes to the sink; values that are wrong are thrown.
template <class P>
P ReadParams(const ParamSet &set, DiagnosticSink &sink) {
    P p;
    ParamReader reader(set);
    p.Describe(reader);
    reader.Finish(sink);
    return p;
}

/// Reads `owner`.name parameters where the set has those of others, too: only wrong values are reported.
template <class P>
void ReadParams(P &p, const ParamSet &set, const std::string &owner) {
    ParamReader reader(set, owner + '.');
    p.Describe(reader);
    reader.ThrowIfErrors();
}

/// A function that reads a P and forgets it: for errors before anything is made.
template <class P>
auto ParamsCheck(std::string owner) {
    return [owner = std::move(owner)](const ParamSet &set) {
        P p;
        ReadParams(p, set, owner);
    };
}

}  // namespace pbrt
