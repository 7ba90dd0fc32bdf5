#pragma once
#include <array>
#include <string>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

// Tables of data/*.csv, embedded into the binary and parsed at first use.

struct TabulatedSpectrum {
    std::string name;
    std::vector<Float> lambdas, values;  ///< nm increasing
};
const std::vector<TabulatedSpectrum> &EmbeddedNamedSpectra();
/// Camera sensors, three rows each, named SENSOR_r, SENSOR_g, SENSOR_b.
const std::vector<TabulatedSpectrum> &EmbeddedSensorResponses();
const std::vector<TabulatedSpectrum> &EmbeddedColorChecker();

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
/// x-bar, y-bar, z-bar at 360, 361, ..., 830 nm.
const ThreeColumnTable &EmbeddedCie1931();
const ThreeColumnTable &EmbeddedDaylight();

}  // namespace pbrt
