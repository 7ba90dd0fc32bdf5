#include "pbrt/films/sensor.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/given_params.h"

namespace pbrt::test {
namespace {

PixelSensor MakeSensor(const std::string &name, Float whiteBalance = 0, Float iso = 100, Float exposure = 1) {
    const Params params = Params().String("sensor", name).Number("whitebalance", whiteBalance).Number("iso", iso);
    DiagnosticSink sink;
    return PixelSensor::Make(ReadParams<SensorParams>(params, sink), params, ColorSpace::SRGB(), exposure);
}

/// The response of a sensor to a radiance spectrum, by equal steps of the sample that chooses wavelengths.
Xyz Measured(const PixelSensor &sensor, const Spectrum &radiance) {
    constexpr int kSteps = 8000;
    glm::dvec3 sum(0);
    for (int i = 0; i < kSteps; ++i) {
        const auto lambda = SampledWavelengths::SampleVisible((Float(i) + Float(0.5)) / kSteps);
        sum += glm::dvec3(sensor.Expose(SafeDivide(radiance.Sample(lambda), lambda.Pdf()), lambda));
    }
    return sensor.XyzFromSensor() * Vector3(sum / double(kSteps));
}

class ProductSpectrum final : public Spectrum {
  public:
    ProductSpectrum(const Spectrum &a, const Spectrum &b) : a_(a), b_(b) {}
    Float operator()(Float lambda) const override { return a_(lambda) * b_(lambda); }
    Float MaxValue() const override { return a_.MaxValue() * b_.MaxValue(); }

  private:
    const Spectrum &a_, &b_;
};

TEST(PixelSensor, CamerasMatchTheStandardObserverOnTheColorChecker) {
    // Under the light for which a camera is balanced, its greys get the output's white, and the colour patches come
    // close to theirs.
    const ColorSpace &space = ColorSpace::SRGB();
    for (const std::string &name : SupportedSensors()) {
        if (name == "cie1931") continue;
        for (Float kelvin : {4500.0f, 6500.0f}) {
            const DenseSpectrum light = DaylightSpectrum(kelvin);
            const PixelSensor sensor = MakeSensor(name, kelvin);
            double squares = 0;
            for (const SpectrumPtr &patch : ColorCheckerReflectances()) {
                const Rgb seen = space.ToRgb(Measured(sensor, ProductSpectrum(*patch, light)) / CieYIntegral);
                const Rgb wanted = space.ToRgb(SpectrumToXyz(ProductSpectrum(*patch, space.Illuminant())));
                squares += double(glm::dot(seen - wanted, seen - wanted)) / 72;
            }
            EXPECT_LT(std::sqrt(squares), 0.05) << name << " " << kelvin;
        }
    }
}

TEST(PixelSensor, DefaultWhiteBalanceOfCamerasIs6500) {
    const PixelSensor given = MakeSensor("nikon_d850", 6500), none = MakeSensor("nikon_d850"),
                      warm = MakeSensor("nikon_d850", 4000);
    EXPECT_EQ(given.XyzFromSensor(), none.XyzFromSensor());
    EXPECT_NE(given.XyzFromSensor(), warm.XyzFromSensor());
    EXPECT_EQ(MakeSensor("cie1931").XyzFromSensor(), glm::mat3(1));
}

TEST(PixelSensor, IsoAndExposureScaleCamerasToo) {
    const DenseSpectrum light = DaylightSpectrum(6500);
    const Xyz one = Measured(MakeSensor("sony_ilce_9"), light);
    const Xyz more = Measured(MakeSensor("sony_ilce_9", 0, 320, 0.25f), light);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(more[c] / one[c], 0.8f, 1e-4f);
}

TEST(PixelSensor, FitRecoversALinearMapAndMinimizesTheError) {
    Rng rng(3);
    auto draw = [&] {
        Float x = rng.Uniform(), y = rng.Uniform();
        return Vector3(x, y, rng.Uniform());
    };
    const glm::mat3 truth(1, 2, -1, 0.5f, -0.25f, 3, 0, 1, 0.75f);
    std::vector<Vector3> from, exact, noisy;
    for (int i = 0; i < 24; ++i) {
        from.push_back(draw());
        exact.push_back(truth * from.back());
        noisy.push_back(exact.back() + 0.3f * draw());
    }
    const glm::mat3 found = FitLinearMap(from, exact), best = FitLinearMap(from, noisy);
    auto error = [&](const glm::mat3 &m) {
        double sum = 0;
        for (size_t i = 0; i < from.size(); ++i) sum += double(LengthSquared(m * from[i] - noisy[i]));
        return sum;
    };
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) {
            EXPECT_NEAR(found[c][r], truth[c][r], 1e-4f);
            for (Float step : {-0.02f, 0.02f}) {
                glm::mat3 other = best;
                other[c][r] += step;
                EXPECT_GT(error(other), error(best));
            }
        }
}

TEST(PixelSensor, ResponsesAreNamedSpectra) {
    for (const std::string &name : CameraSensorNames())
        for (const char *channel : {"_r", "_g", "_b"})
            EXPECT_NE(NamedSpectrum(name + channel), nullptr) << name << channel;
    EXPECT_EQ(ColorCheckerReflectances().size(), 24u);
}

}  // namespace
}  // namespace pbrt::test
