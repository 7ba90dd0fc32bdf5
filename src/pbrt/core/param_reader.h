#pragma once
#include <algorithm>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "pbrt/core/describe.h"

namespace pbrt {

/// Reads a parameter struct from a ParamSet: `p.Describe(reader); reader.Finish(sink);`. Parameters of the set that
/// were not declared are reported as unused, except Attribute defaults.
class ParamReader {
  public:
    explicit ParamReader(const ParamSet &set, std::string prefix = {}) : set_(set), prefix_(std::move(prefix)) {}
    /// Continues another reader of the same set: parameters declared there count as declared here.
    ParamReader(const ParamSet &set, const ParamReader &other) : set_(set), declared_(other.declared_) {}

    bool When(bool applies) const { return applies; }
    void OnlyWith(const char *, const char *) const {}
    template <class T>
    void operator()(const std::string &name, T &value, const char *) {
        Collect(errors_, [&] { ReadParam(*this, prefix_ + name, value); });
    }
    template <class T, class Constraint>
    void operator()(const std::string &name, T &value, const Constraint &constraint, const char *) {
        Collect(errors_, [&] { ReadParam(*this, prefix_ + name, value, constraint); });
    }

    /// Reports undeclared parameters, or those declared with another type, to the sink. Throws one UserError with all
    /// invalid values.
    void Finish(DiagnosticSink &sink) const {
        for (const Param &p : set_.Own()) {
            auto isNamed = [&](const Declared &d) { return d.name == p.name; };
            auto isThis = [&](const Declared &d) { return d.type == p.type && d.name == p.name; };
            if (std::any_of(declared_.begin(), declared_.end(), isThis)) continue;
            if (sink.IsFull()) {
                sink.Error(p.loc, "unused parameter.");
                continue;
            }
            const std::string what = fmt::format("\"{} {}\": unused parameter", Name(p.type), Abbreviate(p.name));
            if (std::any_of(declared_.begin(), declared_.end(), isNamed)) {
                std::string types;
                for (const Declared &d : declared_)
                    if (isNamed(d))
                        types += fmt::format("{}\"{} {}\"", types.empty() ? "" : " or ", Name(d.type), d.name);
                sink.Error(p.loc, "{}: {} takes {}.", what, set_.What(), types);
                continue;
            }
            std::set<std::string> names;
            for (const Declared &d : declared_) names.insert(d.name);
            sink.Error(p.loc, "{} of {}; {}{}.", what, set_.What(), OldNameHint("parameter", p.name),
                       ListChoices(p.name, {names.begin(), names.end()}));
        }
        ThrowIfErrors();
    }
    void ThrowIfErrors() const { errors_.ThrowIfErrors(); }

    const ParamSet &Set() const { return set_; }
    const Param *Take(const std::string &name, ParamType type) {
        Declare(name, type);
        return set_.Find(name, type);
    }
    void Declare(const std::string &name, ParamType type) { declared_.push_back({name, type}); }

  private:
    struct Declared {
        std::string name;
        ParamType type;
    };

    const ParamSet &set_;
    std::string prefix_;
    std::vector<Declared> declared_;
    DiagnosticSink errors_;
};

namespace detail {
template <class T>
const auto &ValuesOf(const Param &p) {
    if constexpr (std::is_same_v<T, int>) return p.ints;
    else if constexpr (std::is_same_v<T, bool>) return p.bools;
    else if constexpr (std::is_same_v<T, std::string>) return p.strings;
    else return p.floats;
}
/// Throws UserError unless `found == wanted`.
inline void RequireCount(const ParamSet &set, const Param &p, size_t found, size_t wanted) {
    if (found == wanted) return;
    throw UserError(p.loc, "{}: \"{} {}\" takes {}, found {}.", set.What(), Name(p.type), p.name,
                    CountText(wanted, "value"), found);
}
template <class T>
void RequireRange(const ParamSet &set, const Param &p, T value, const Range<T> &range) {
    if (!range.Contains(value))
        throw UserError(p.loc, "{}: \"{}\" is {}; it must be {}.", set.What(), p.name, value, Text(range));
}
[[noreturn]] inline void ThrowMissing(const ParamSet &set, const std::string &name, ParamType type) {
    throw set.Error(name, "\"{} {}\" is missing.", Name(type), name);
}
[[noreturn]] inline void ThrowNoChoice(const ParamSet &set, const Param &p, const Choices &choices) {
    throw UserError(p.loc, "{}: \"{}\" is not a choice for \"{}\"; {}.", set.What(), Abbreviate(p.strings[0]), p.name,
                    ListChoices(p.strings[0], choices));
}
/// The parameter, which must have exactly one value; null if absent.
template <class T>
const Param *TakeOne(ParamReader &reader, const std::string &name) {
    const Param *p = reader.Take(name, TypeOf<T>());
    if (p) RequireCount(reader.Set(), *p, ValuesOf<T>(*p).size(), 1);
    return p;
}
}  // namespace detail

template <class T>
void ReadParam(ParamReader &reader, const std::string &name, T &value) {
    if (const Param *p = detail::TakeOne<T>(reader, name)) value = detail::ValuesOf<T>(*p)[0];
}
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::optional<T> &value) {
    if (const Param *p = detail::TakeOne<T>(reader, name)) value = detail::ValuesOf<T>(*p)[0];
}
template <class T, class U>
void ReadParam(ParamReader &reader, const std::string &name, T &value, const Range<U> &range) {
    const Param *p = detail::TakeOne<U>(reader, name);
    if (!p) return;
    detail::RequireRange(reader.Set(), *p, detail::ValuesOf<U>(*p)[0], range);
    value = detail::ValuesOf<U>(*p)[0];
}
inline void ReadParam(ParamReader &reader, const std::string &name, std::string &value, const Choices &choices) {
    const Param *p = detail::TakeOne<std::string>(reader, name);
    if (!p) return;
    if (std::find(choices.begin(), choices.end(), p->strings[0]) == choices.end())
        detail::ThrowNoChoice(reader.Set(), *p, choices);
    value = p->strings[0];
}
template <class E, size_t N>
void ReadParam(ParamReader &reader, const std::string &name, E &value, const NamedValue<E> (&values)[N]) {
    const Param *p = detail::TakeOne<std::string>(reader, name);
    if (!p) return;
    Choices names;
    for (const NamedValue<E> &v : values) {
        if (p->strings[0] == v.name) {
            value = v.value;
            return;
        }
        names.push_back(v.name);
    }
    detail::ThrowNoChoice(reader.Set(), *p, names);
}
inline void ReadParam(ParamReader &reader, const std::string &name, std::string &value, Required) {
    ReadParam(reader, name, value);
    if (value.empty()) detail::ThrowMissing(reader.Set(), name, ParamType::String);
}

/// The span refers to values in the set, which must outlive it.
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
        for (T v : *values) detail::RequireRange(reader.Set(), *reader.Set().Find(name, detail::TypeOf<T>()), v, range);
}

/// T is a point, colour etc. whose memory is exactly the numbers of one item.
template <class T>
void ReadParam(ParamReader &reader, const std::string &name, std::vector<T> &values, const Items &items) {
    static_assert(std::is_trivially_copyable_v<T>);
    PBRT_DCHECK(sizeof(T) == ItemSize(items.type) * sizeof(Float));
    const Param *p = reader.Take(name, items.type);
    if (items.isRequired && (!p || p->floats.empty())) detail::ThrowMissing(reader.Set(), name, items.type);
    if (!p) return;
    if (p->floats.size() % ItemSize(p->type) != 0)
        throw UserError(p->loc, "{}: \"{} {}\" takes groups of {} values, found {}.", reader.Set().What(),
                        Name(p->type), p->name, ItemSize(p->type), p->floats.size());
    if (items.range.low > AnyFloat().low)
        for (Float v : p->floats) detail::RequireRange(reader.Set(), *p, v, items.range);
    values.resize(p->floats.size() * sizeof(Float) / sizeof(T));
    if (!values.empty()) std::memcpy(static_cast<void *>(values.data()), p->floats.data(), values.size() * sizeof(T));
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

/// Reads a parameter struct. Parameters that P does not declare are reported to the sink; invalid values are thrown as
/// one UserError.
template <class P>
P ReadParams(const ParamSet &set, DiagnosticSink &sink) {
    P p;
    ParamReader reader(set);
    p.Describe(reader);
    reader.Finish(sink);
    return p;
}

/// Reads the parameters called `owner`.name from a shared set. Only invalid values are errors, thrown as one UserError.
template <class P>
void ReadParams(P &p, const ParamSet &set, const std::string &owner) {
    ParamReader reader(set, owner + '.');
    p.Describe(reader);
    reader.ThrowIfErrors();
}

}  // namespace pbrt
