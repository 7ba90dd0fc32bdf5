#pragma once
#include <nlohmann/json.hpp>

#include "pbrt/core/describe.h"

namespace pbrt {

/// EffectiveParams as text. Numbers are printed in their shortest single-precision form: 0.01, not
/// 0.009999999776482582.
template <class P>
std::string EffectiveParamsText(const P &params) {
    using FloatJson =
        nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, int64_t, uint64_t, Float>;
    return EffectiveParams<P, FloatJson>(params).dump();
}

}  // namespace pbrt
