#pragma once
#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt {

/// Products of matching functions and illuminant, so that a reflectance's XYZ is a plain sum; reflectance 1 has Y = 1.
/// Zero-padded to whole vectors.
struct ReflectanceWeights {
    std::vector<double> position;                ///< wavelength mapped to [0, 1]
    std::array<std::vector<double>, 3> weights;  ///< X, Y, Z
};

/// XYZ of the sigmoid of (c[0] t + c[1]) t + c[2], t = position, and jacobian[k][j] = d xyz[k] / d c[j].
struct SigmoidIntegrals {
    double xyz[3];
    double jacobian[3][3];
};
void IntegrateSigmoid(const ReflectanceWeights &w, const double c[3], SigmoidIntegrals *result);

/// Fits reflectances s(lambda) = sigmoid(quadratic) to RGB values of one colour space under its illuminant: least
/// squares in CIELAB (Jakob and Hanika 2019, section 4), by Gauss-Newton with an analytic Jacobian.
class SigmoidFit {
  public:
    explicit SigmoidFit(const RgbPrimaries &space);

    /// `c`: initial value and result, for wavelength mapped to [0, 1]. Returns the CIELAB distance before the last
    /// step. The largest coefficient, by value and not by magnitude, is limited to 200 by scaling all three. Colours
    /// outside the gamut of reflectances thus end at a steep step, whose wavelength depends on the bound. Their images
    /// agree with stock pbrt-v4 to 0.1 %; bounding magnitudes would change them by up to 6 %. Steps are not damped,
    /// because the reference, stock's tables, comes from at most 15 undamped ones; damping changes dark channels by up
    /// to 30 %.
    double Fit(const double rgb[3], double c[3]) const;

    static void ToNanometres(const double c[3], float out[3]);

  private:
    void Lab(const double xyz[3], double lab[3], double derivative[3]) const;
    double Residual(const double c[3], const double target[3], double r[3], double jacobian[3][3]) const;

    ReflectanceWeights weights_;
    double white_[3];
    glm::dmat3 xyzFromRgb_;
};

}  // namespace pbrt
