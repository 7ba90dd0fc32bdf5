#include "pbrt/spectra/color_space.h"
#include "pbrt/spectra/rgb_primaries.h"
#include "pbrt/spectra/spectral_data.h"

namespace pbrt {

glm::mat3 WhiteBalanceMatrix(const Point2 &from, const Point2 &to) {
    // Bradford cone responses from XYZ; GLM takes columns.
    const glm::dmat3 conesFromXyz(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
    glm::dvec3 gain =
        (conesFromXyz * glm::dvec3(XyzFromChromaticity(to))) / (conesFromXyz * glm::dvec3(XyzFromChromaticity(from)));
    glm::dmat3 scale(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z);
    return glm::mat3(glm::inverse(conesFromXyz) * scale * conesFromXyz);
}

DenseSpectrum DaylightSpectrum(Float kelvin) {
    // The illuminants were defined with the radiation constant c2 = 1.4380e-2, to which nominal temperatures refer.
    double cct = double(kelvin) * (1.4388 / 1.4380);
    std::vector<Float> values;
    if (cct < 4000) {
        // CIE daylight is undefined below 4000 K; stock pbrt-v4 uses a black body there.
        BlackbodySpectrum blackbody(static_cast<Float>(cct));
        for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) values.push_back(blackbody(lambda));
    } else {
        double i = 1 / cct;
        double x = cct <= 7000 ? ((-4.607e9 * i + 2.9678e6) * i + 0.09911e3) * i + 0.244063
                               : ((-2.0064e9 * i + 1.9018e6) * i + 0.24748e3) * i + 0.23704;
        double y = (-3 * x + 2.87) * x - 0.275;
        double m = 0.0241 + 0.2562 * x - 0.7341 * y;
        auto m1 = static_cast<Float>((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
        auto m2 = static_cast<Float>((0.0300 - 31.4424 * x + 30.0717 * y) / m);
        const ThreeColumnTable &s = EmbeddedDaylight();
        std::vector<Float> sum(s.lambdas.size());
        for (size_t k = 0; k < sum.size(); ++k) sum[k] = s.columns[0][k] + m1 * s.columns[1][k] + m2 * s.columns[2][k];
        PiecewiseLinearSpectrum linear(s.lambdas, sum);
        for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) values.push_back(linear(lambda));
    }
    Float y = SpectrumToXyz(DenseSpectrum(values)).y;
    for (Float &v : values) v /= y;
    return DenseSpectrum(values);
}

}  // namespace pbrt
