#pragma once
#include "pbrt/core/params.h"

namespace pbrt {

inline Float GetAboveZero(const ParamSet &params, const char *name, Float defaultValue) {
    Float v = params.GetFloat(name, defaultValue);
    if (!(v > 0))
        throw UserError(fmt::format("{}: \"{}\" is {}; it must be above 0.", params.What(), name, v),
                        params.LocOf(name));
    return v;
}

}  // namespace pbrt
