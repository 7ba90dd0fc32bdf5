#pragma once
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/films/film_frame.h"
#include "pbrt/films/film_params.h"
#include "pbrt/films/film_state.h"
#include "pbrt/films/sensor.h"
#include "pbrt/films/splats.h"
#include "pbrt/images/image.h"
#include "pbrt/math/precise_sum.h"

namespace pbrt {

/// Sums of what the sensor measures in every pixel, which all films have: weighted sums of samples and sums of splats.
class SensorSums {
  public:
    /// `set`: what the parameters were read from.
    SensorSums(const FilmParams &params, const ParamSet &set, const FilmFrame &frame, Float exposureTime);
    /// An object with the same sensor and empty sums.
    SensorSums MakeEmpty(const FilmFrame &frame) const;
    /// Memory for the sums of a pixel and its red, green and blue in the picture.
    static constexpr double kBytesPerPixel = 4 * sizeof(PreciseSum) + 3 * sizeof(float);

    /// What the sensor measures, scaled down to maxcomponentvalue if it is larger. Empty if it is not finite, which is
    /// counted as rejected.
    std::optional<Vector3> Measure(const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);
    void Add(size_t pixel, const Vector3 &sensor, Float weight) {
        Pixel &sums = pixels_[pixel];
        for (int c = 0; c < 3; ++c) sums.sensor[c].Add(double(weight) * double(sensor[c]));
        sums.weight.Add(double(weight));
    }

    void ExpectSplats() { splats_.Expect(3 * pixels_.size()); }
    /// False if the splat is not finite or larger than FixedSum holds; it is counted as rejected.
    bool AddSplat(size_t pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);
    void AddSplatPaths(uint64_t paths) { counts_.splatPaths += paths; }
    /// Factor that turns a sum of splats into their mean over the samples that a pixel would have of as many paths.
    double SplatScale() const { return counts_.splatPaths ? fullPixels_ / static_cast<double>(counts_.splatPaths) : 0; }

    Float MaxComponentValue() const { return maxComponent_; }
    /// Counts something that was dropped; from any thread.
    void Reject() { std::atomic_ref(counts_.rejected).fetch_add(1, std::memory_order_relaxed); }
    uint64_t Rejected() const { return counts_.rejected; }
    /// An image with R, G, B filled and further channels for the film to fill; reports what was cut or dropped.
    Image MakeImage(const std::vector<std::string> &furtherChannels) const;
    /// An image of R, G and B in float precision; reports nothing.
    Image Colors() const;
    void AppendBlocks(std::vector<StateBlock> &blocks) const;

  private:
    SensorSums(const FilmFrame &frame, Float maxComponent, const PixelSensor &sensor);
    struct Pixel {
        PreciseSum sensor[3];  ///< of weight * XYZ or camera RGB
        PreciseSum weight;
        void operator+=(const Pixel &p) {
            for (int c = 0; c < 3; ++c) sensor[c] += p.sensor[c];
            weight += p.weight;
        }
    };
    struct Counts {
        uint64_t rejected = 0, splatPaths = 0;
        void operator+=(const Counts &c) {
            rejected += c.rejected;
            splatPaths += c.splatPaths;
        }
    };
    /// Of the picture, in float precision.
    Rgb ColorOf(size_t pixel) const;
    Point2i resolution_;
    double fullPixels_;  ///< of the whole picture, also if only a part is rendered
    bool half_;
    Float maxComponent_;
    PixelSensor sensor_;
    glm::mat3 outputFromSensor_{1};
    std::vector<Pixel> pixels_;
    Splats splats_;
    Counts counts_;
};

inline std::optional<Vector3> SensorSums::Measure(const SampledSpectrum &L, const SampledWavelengths &lambda,
                                                  Float weight) {
    Vector3 sensor = sensor_.Expose(SafeDivide(L, lambda.Pdf()), lambda);
    if (!std::isfinite(sensor.x + sensor.y + sensor.z) || !std::isfinite(weight)) {
        Reject();
        return {};
    }
    Float largest = MaxComponent(sensor);
    if (largest > maxComponent_) sensor *= maxComponent_ / largest;
    return sensor;
}

}  // namespace pbrt
