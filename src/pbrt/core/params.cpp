#include "pbrt/core/params.h"

#include <algorithm>
#include <array>

namespace pbrt {

size_t ItemSize(ParamType type) {
    switch (type) {
        case ParamType::Point2:
        case ParamType::Vector2:
            return 2;
        case ParamType::Point3:
        case ParamType::Vector3:
        case ParamType::Normal:
        case ParamType::Rgb:
            return 3;
        default:
            return 1;
    }
}

namespace {

template <class T>
const T &Single(const Param &p, const std::vector<T> &values, const std::string &what) {
    if (values.size() != 1)
        throw UserError(
            fmt::format("{}: expected one value for \"{} {}\", found {}.", what, Name(p.type), p.name, values.size()),
            p.loc);
    return values[0];
}

}  // namespace

const char *Name(ParamType type) {
    static constexpr std::array<const char *, 13> kNames = {"integer",   "float",    "point2", "vector2", "point3",
                                                            "vector3",   "normal",   "bool",   "string",  "rgb",
                                                            "blackbody", "spectrum", "texture"};
    return kNames[static_cast<size_t>(type)];
}

const Param *ParamSet::FindAndNote(std::string_view name, ParamType type) const {
    std::vector<ParamType> &types = asked_[std::string(name)];
    if (std::find(types.begin(), types.end(), type) == types.end()) types.push_back(type);
    const Param *found = nullptr;
    for (const std::vector<Param> *list : {&defaults_, &params_})
        for (const Param &p : *list)
            if (p.type == type && p.name == name) {
                p.used = true;
                found = &p;
            }
    return found;
}

const Param *ParamSet::Find(std::string_view name, ParamType type) const { return FindAndNote(name, type); }

bool ParamSet::Has(std::string_view name) const {
    auto matches = [&](const Param &p) { return p.name == name; };
    return std::any_of(params_.begin(), params_.end(), matches) ||
           std::any_of(defaults_.begin(), defaults_.end(), matches);
}

int ParamSet::GetInt(std::string_view name, int defaultValue) const {
    const Param *p = FindAndNote(name, ParamType::Integer);
    return p ? Single(*p, p->ints, what_) : defaultValue;
}

Float ParamSet::GetFloat(std::string_view name, Float defaultValue) const {
    const Param *p = FindAndNote(name, ParamType::Float);
    return p ? Single(*p, p->floats, what_) : defaultValue;
}

int ParamSet::GetInt(std::string_view name, int defaultValue, const Range<int> &range) const {
    const Param *p = FindAndNote(name, ParamType::Integer);
    if (!p) return defaultValue;
    const int value = Single(*p, p->ints, what_);
    Require(name, value, range);
    return value;
}

Float ParamSet::GetFloat(std::string_view name, Float defaultValue, const Range<Float> &range) const {
    const Param *p = FindAndNote(name, ParamType::Float);
    if (!p) return defaultValue;
    const Float value = Single(*p, p->floats, what_);
    Require(name, value, range);
    return value;
}

bool ParamSet::GetBool(std::string_view name, bool defaultValue) const {
    const Param *p = FindAndNote(name, ParamType::Bool);
    return p ? Single(*p, p->bools, what_) != 0 : defaultValue;
}

std::string ParamSet::GetString(std::string_view name, std::string_view defaultValue) const {
    const Param *p = FindAndNote(name, ParamType::String);
    return p ? Single(*p, p->strings, what_) : std::string(defaultValue);
}

std::string ParamSet::GetChoice(std::string_view name, std::string_view defaultValue,
                                const std::vector<std::string> &choices) const {
    std::string value = GetString(name, defaultValue);
    if (std::find(choices.begin(), choices.end(), value) == choices.end())
        throw UserError(fmt::format("{}: \"{}\" is not a choice for \"{}\"; {}.", what_, Abbreviate(value), name,
                                    ListChoices(value, choices)),
                        LocOf(name));
    return value;
}

std::span<const Float> ParamSet::GetFloats(std::string_view name, ParamType type) const {
    const Param *p = FindAndNote(name, type);
    if (!p) return {};
    size_t item = ItemSize(type);
    if (p->floats.size() % item != 0)
        throw UserError(fmt::format("{}: \"{} {}\" takes groups of {} values, found {}.", what_, Name(type), name, item,
                                    p->floats.size()),
                        p->loc);
    return p->floats;
}

std::span<const int> ParamSet::GetInts(std::string_view name) const {
    const Param *p = FindAndNote(name, ParamType::Integer);
    if (!p) return {};
    return p->ints;
}

std::span<const std::string> ParamSet::GetStrings(std::string_view name) const {
    const Param *p = FindAndNote(name, ParamType::String);
    if (!p) return {};
    return p->strings;
}

UserError ParamSet::Error(std::string_view name, std::string_view message) const {
    return UserError(fmt::format("{}: {}", what_, message), LocOf(name));
}

void ParamSet::Warn(DiagnosticSink &sink, std::string_view name, std::string_view message) const {
    sink.Warning(LocOf(name), fmt::format("{}: {}", what_, message));
}

FileLoc ParamSet::LocOf(std::string_view name) const {
    for (const std::vector<Param> *list : {&params_, &defaults_})
        for (auto p = list->rbegin(); p != list->rend(); ++p)
            if (p->name == name) return p->loc;
    return loc_;
}

void ParamSet::ReportUnused(DiagnosticSink &sink) const {
    for (const Param &p : params_) {
        if (p.used) continue;
        if (sink.IsFull()) {
            sink.Error(p.loc, "unused parameter.");
            continue;
        }
        auto asked = asked_.find(p.name);
        if (asked != asked_.end()) {
            std::string types;
            for (ParamType type : asked->second)
                types += fmt::format("{}\"{} {}\"", types.empty() ? "" : " or ", Name(type), p.name);
            sink.Error(p.loc, fmt::format("\"{} {}\": unused parameter: {} takes {}.", Name(p.type), Abbreviate(p.name),
                                          what_, types));
            continue;
        }
        std::vector<std::string> names;
        for (const auto &[name, types] : asked_) names.push_back(name);
        sink.Error(p.loc, fmt::format("\"{} {}\": unused parameter of {}; {}.", Name(p.type), Abbreviate(p.name), what_,
                                      ListChoices(p.name, names)));
    }
}

void ParamSet::MarkAllUsed() const {
    for (const Param &p : params_) p.used = true;
}

}  // namespace pbrt
