#pragma once
#include <string>
#include <vector>

#include "pbrt/core/params.h"

// Single parameters without a place in a file.
namespace pbrt::test {

inline Param FloatParam(const std::string &name, std::vector<Float> values, ParamType type = ParamType::Float) {
    Param p;
    p.type = type;
    p.name = name;
    p.floats = std::move(values);
    return p;
}
inline Param IntParam(const std::string &name, std::vector<int> values) {
    Param p;
    p.type = ParamType::Integer;
    p.name = name;
    p.ints = std::move(values);
    return p;
}
inline Param IntParam(const std::string &name, int value) { return IntParam(name, std::vector{value}); }
inline Param StringParam(const std::string &name, const std::string &value, ParamType type = ParamType::String) {
    Param p;
    p.type = type;
    p.name = name;
    p.strings = {value};
    return p;
}
inline Param BoolParam(const std::string &name, bool value) {
    Param p;
    p.type = ParamType::Bool;
    p.name = name;
    p.bools = {uint8_t(value)};
    return p;
}

}  // namespace pbrt::test
