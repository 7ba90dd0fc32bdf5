#pragma once
#include <array>
#include <vector>

namespace pbrt {

/// Products of matching functions and illuminant, so that a reflectance's XYZ is a plain sum; reflectance 1 has Y = 1.
/// Zero-padded to whole vectors.
struct ReflectanceWeights {
    std::vector<double> position;                ///< wavelength mapped to [0, 1]
    std::array<std::vector<double>, 3> weights;  ///< X, Y, Z
};

/// XYZ of the sigmoid of (c[0] t + c[1]) t + c[2], t = position, and its derivatives jacobian[k][j] = d xyz[k] / d
/// c[j].
struct SigmoidIntegrals {
    double xyz[3];
    double jacobian[3][3];
};
void IntegrateSigmoid(const ReflectanceWeights &w, const double c[3], SigmoidIntegrals *result);

}  // namespace pbrt
