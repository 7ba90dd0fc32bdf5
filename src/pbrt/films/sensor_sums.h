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
#include "pbrt/math/statistics.h"

namespace pbrt {

/// Per-pixel sums common to all films: weighted sensor samples and splats.
class SensorSums {
  public:
    SensorSums(const FilmParams &params, const ParamSet &set, const FilmFrame &frame, Float exposureTime);
    SensorSums MakeEmpty(const FilmFrame &frame) const;
    static constexpr double kBytesPerPixel = 4 * sizeof(PreciseSum) + 3 * sizeof(float);

    /// Sensor value, scaled down to maxcomponentvalue if larger. Empty and counted as rejected if not finite.
    std::optional<Vector3> Measure(const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);
    void Add(size_t pixel, const Vector3 &sensor, Float weight) {
        Pixel &sums = pixels_[pixel];
        for (int c = 0; c < 3; ++c) sums.sensor[c].Add(double(weight) * double(sensor[c]));
        sums.weight.Add(double(weight));
    }

    void ExpectSplats() { splats_.Expect(3 * pixels_.size()); }
    /// False, and counted as rejected, if not finite or beyond FixedSum's range.
    bool AddSplat(size_t pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);
    void AddSplatPaths(uint64_t paths) { counts_.splatPaths += paths; }
    /// Factor from a splat sum to the mean over the samples that a pixel would have of as many paths.
    double SplatScale() const { return counts_.splatPaths ? fullPixels_ / static_cast<double>(counts_.splatPaths) : 0; }

    Float MaxComponentValue() const { return maxComponent_; }
    /// Counts a dropped value; thread-safe.
    void Reject() { std::atomic_ref(counts_.rejected).fetch_add(1, std::memory_order_relaxed); }
    uint64_t Rejected() const { return counts_.rejected; }
    /// Image with R, G, B filled and further channels for the film to fill; reports clamped and dropped values.
    Image MakeImage(const std::vector<std::string> &furtherChannels) const;
    /// R, G and B in float precision, without messages.
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
    /// Output colour in float precision.
    Rgb ColorOf(size_t pixel) const;
    Point2i resolution_;
    double fullPixels_;  ///< of the full image, also for crops
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
