#include "pbrt/core/param_reader.h"

#include <set>

namespace pbrt {

size_t ItemSize(ParamType type) {
    switch (type) {
        case ParamType::Point2:
        case ParamType::Vector2: return 2;
        case ParamType::Point3:
        case ParamType::Vector3:
        case ParamType::Normal:
        case ParamType::Rgb: return 3;
        default: return 1;
    }
}

const Param *ParamSet::Find(std::string_view name, std::optional<ParamType> type) const {
    for (const std::vector<Param> *list : {&params_, &defaults_})
        for (auto p = list->rbegin(); p != list->rend(); ++p)
            if (p->name == name && (!type || p->type == *type)) return &*p;
    return nullptr;
}

UserError ParamSet::Error(std::string_view name, std::string_view message) const {
    return UserError(LocOf(name), "{}: {}", what_, message);
}

void ParamSet::Warn(DiagnosticSink &sink, std::string_view name, std::string_view message) const {
    sink.Warning(LocOf(name), "{}: {}", what_, message);
}

FileLoc ParamSet::LocOf(std::string_view name) const {
    const Param *p = Find(name);
    return p ? p->loc : loc_;
}

void ParamReader::ReportUnused(DiagnosticSink &sink) const {
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
                if (isNamed(d)) types += fmt::format("{}\"{} {}\"", types.empty() ? "" : " or ", Name(d.type), d.name);
            sink.Error(p.loc, "{}: {} takes {}.", what, set_.What(), types);
            continue;
        }
        std::set<std::string> names;
        for (const Declared &d : declared_) names.insert(d.name);
        sink.Error(p.loc, "{} of {}; {}{}.", what, set_.What(), OldNameHint("parameter", p.name),
                   ListChoices(p.name, {names.begin(), names.end()}));
    }
}

namespace detail {

void RequireCount(const ParamSet &set, const Param &p, size_t found, size_t wanted) {
    if (found == wanted) return;
    throw UserError(p.loc, "{}: \"{} {}\" takes {}, found {}.", set.What(), Name(p.type), p.name,
                    CountText(wanted, "value"), found);
}

void RequireItems(const ParamSet &set, const Param &p) {
    const size_t item = ItemSize(p.type);
    if (p.floats.size() % item != 0)
        throw UserError(p.loc, "{}: \"{} {}\" takes groups of {} values, found {}.", set.What(), Name(p.type), p.name,
                        item, p.floats.size());
}

void ThrowMissing(const ParamSet &set, const std::string &name, ParamType type) {
    throw set.Error(name, "\"{} {}\" is missing.", Name(type), name);
}

void ThrowNoChoice(const ParamSet &set, const Param &p, const Choices &choices) {
    throw UserError(p.loc, "{}: \"{}\" is not a choice for \"{}\"; {}.", set.What(), Abbreviate(p.strings[0]), p.name,
                    ListChoices(p.strings[0], choices));
}

}  // namespace detail

}  // namespace pbrt
