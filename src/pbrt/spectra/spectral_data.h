#pragma once
#include <array>
#include <string>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

// Tables of data/*.csv, embedded into the binary and parsed at first use. Named spectra: spectrum.h.

struct ScatteringPreset {
    std::string name;
    std::array<Float, 3> reducedScattering, absorption;  ///< 1/mm, linear sRGB
};
/// Media of pbrt-v4-format §16, in the order of the file.
const std::vector<ScatteringPreset> &EmbeddedScatteringPresets();

struct ThreeColumnTable {
    std::vector<Float> lambdas;  ///< nm
    std::array<std::vector<Float>, 3> columns;
};
/// Components of CIE daylight.
const ThreeColumnTable &EmbeddedDaylight();

}  // namespace pbrt
