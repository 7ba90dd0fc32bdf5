#include "pbrt/core/params.h"

#include <algorithm>

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

const Param *ParamSet::Find(std::string_view name, ParamType type) const {
    for (const std::vector<Param> *list : {&params_, &defaults_})
        for (auto p = list->rbegin(); p != list->rend(); ++p)
            if (p->type == type && p->name == name) return &*p;
    return nullptr;
}

bool ParamSet::Has(std::string_view name) const {
    auto matches = [&](const Param &p) { return p.name == name; };
    return std::ranges::any_of(params_, matches) || std::ranges::any_of(defaults_, matches);
}

UserError ParamSet::Error(std::string_view name, std::string_view message) const {
    return UserError(LocOf(name), "{}: {}", what_, message);
}

void ParamSet::Warn(DiagnosticSink &sink, std::string_view name, std::string_view message) const {
    sink.Warning(LocOf(name), "{}: {}", what_, message);
}

FileLoc ParamSet::LocOf(std::string_view name) const {
    for (const std::vector<Param> *list : {&params_, &defaults_})
        for (auto p = list->rbegin(); p != list->rend(); ++p)
            if (p->name == name) return p->loc;
    return loc_;
}

}  // namespace pbrt
