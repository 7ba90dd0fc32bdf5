#pragma once
#include <atomic>
#include <limits>

#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "pbrt/films/film.h"
#include "pbrt/films/fixed_sum.h"
#include "pbrt/math/statistics.h"

namespace pbrt {

/// Splat sums per pixel; adding is thread-safe.
class Splats {
  public:
    /// Allocates `count` sums, once. Throws UserError if memory is insufficient.
    void Expect(size_t count) {
        if (!sums_.empty()) return;
        RequireMemory(double(count) * sizeof(FixedSum), "the film: splats of light paths", {});
        sums_.resize(count);
    }
    bool AreExpected() const { return !sums_.empty(); }
    void Add(size_t index, double x) { sums_[index].Add(x); }
    double Sum(size_t index) const { return sums_[index].Value(); }

    StateBlock Block(const char *name) const {
        StateBlock block = MakeStateBlock(name, std::span(sums_));
        block.isOfSplats = true;
        return block;
    }

  private:
    std::vector<FixedSum> sums_;
};

/// The `rgb` film: weighted sensor samples and splats per pixel. Base of films with further channels.
class RgbFilm : public Film {
  public:
    RgbFilm(const FilmParams &params, const ParamSet &set, const FilmRequest &request)
        : RgbFilm("rgb", params, set, request, 0) {}

    void AddSample(const FilmSample &sample) override { AddColor(sample); }
    void ExpectSplats() override { splats_.Expect(3 * pixels_.size()); }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override {
        if (PixelBounds().Contains(pixel)) AddSensorSplat(Frame().IndexOf(pixel), L, lambda, weight);
    }
    void AddSplatPaths(uint64_t paths) final { counts_.splatPaths += paths; }
    Image ToImage() const override { return MakeImage({}); }
    Image Colors() const final {
        Image image(PixelFormat::Float, Resolution(), {"R", "G", "B"}, ColorEncoding{ColorEncoding::Kind::Linear});
        auto *values = static_cast<float *>(image.Data());
        ParallelForEach(pixels_.size(), 1 << 12, [&](int64_t i) {
            const Rgb rgb = ColorOf(i);
            for (int c = 0; c < 3; ++c) values[3 * i + c] = rgb[c];
        });
        return image;
    }
    uint64_t RejectedSamples() const final { return counts_.rejected; }
    std::unique_ptr<Film> MakeRgbFilm() const final {
        FilmFrame frame = Frame();
        frame.half = false;
        return std::unique_ptr<Film>(new RgbFilm("rgb", frame, maxComponent_, sensor_));
    }

  protected:
    /// `furtherBytes`: per pixel, of sums and channels besides those of RGB; 0: no further channels.
    RgbFilm(const std::string &kind, const FilmParams &params, const ParamSet &set, const FilmRequest &request,
            double furtherBytes)
        : RgbFilm{kind, request.Frame(params, set, furtherBytes > 0, kBytesPerPixel + furtherBytes),
                  params.maxComponentValue,
                  PixelSensor::Make(params.sensor, set, request.context.outputSpace, request.context.exposureTime)} {}
    std::vector<StateBlock> Blocks() const override {
        return {MakeStateBlock("sensor", std::span(pixels_)), splats_.Block("sensor splats"),
                MakeStateBlock("counts", std::span(&counts_, 1))};
    }

    /// Sensor value, scaled down to maxcomponentvalue if larger. Empty and counted as rejected if not finite.
    std::optional<Vector3> Measure(const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
        Vector3 sensor = sensor_.Expose(SafeDivide(L, lambda.Pdf()), lambda);
        if (!std::isfinite(sensor.x + sensor.y + sensor.z) || !std::isfinite(weight)) {
            Reject();
            return {};
        }
        Float largest = MaxComponent(sensor);
        if (largest > maxComponent_) sensor *= maxComponent_ / largest;
        return sensor;
    }
    /// Adds the sample to its pixel. Returns its sensor value, as Measure.
    std::optional<Vector3> AddColor(const FilmSample &sample) {
        const std::optional<Vector3> sensor = Measure(sample.L, sample.lambda, sample.weight);
        if (!sensor) return {};
        Pixel &sums = pixels_[Frame().IndexOf(sample.pixel)];
        for (int c = 0; c < 3; ++c) sums.sensor[c].Add(double(sample.weight) * double((*sensor)[c]));
        sums.weight.Add(double(sample.weight));
        return sensor;
    }
    /// False, and counted as rejected, if not finite or beyond FixedSum's range.
    bool AddSensorSplat(size_t pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
        const std::optional<Vector3> sensor = Measure(L, lambda, weight);
        if (!sensor) return false;
        const glm::dvec3 weighted = double(weight) * glm::dvec3(*sensor);
        for (int c = 0; c < 3; ++c)
            if (!FixedSum::Holds(weighted[c])) {
                Reject();
                return false;
            }
        for (int c = 0; c < 3; ++c) splats_.Add(3 * pixel + c, weighted[c]);
        return true;
    }
    /// Factor from a splat sum to the mean over the samples that a pixel would have of as many paths.
    double SplatScale() const { return counts_.splatPaths ? Frame().FullPixels() / double(counts_.splatPaths) : 0; }
    Float MaxComponentValue() const { return maxComponent_; }
    /// Counts a dropped value; thread-safe.
    void Reject() { std::atomic_ref(counts_.rejected).fetch_add(1, std::memory_order_relaxed); }
    /// Image with R, G, B filled and further channels for the film to fill; reports clamped and dropped values.
    Image MakeImage(const std::vector<std::string> &furtherChannels) const {
        std::vector<std::string> channels = {"R", "G", "B"};
        channels.insert(channels.end(), furtherChannels.begin(), furtherChannels.end());
        const bool half = Frame().half;
        Image image(half ? PixelFormat::Half : PixelFormat::Float, Resolution(), channels,
                    ColorEncoding{ColorEncoding::Kind::Linear});
        uint64_t clamped = 0;
        size_t i = 0;
        ForEachPixel(image, [&](Point2i p) {
            Rgb rgb = ColorOf(i++);
            for (int c = 0; c < 3; ++c) {
                if (half && rgb[c] > kMaxHalf) {
                    rgb[c] = kMaxHalf;
                    ++clamped;
                }
                image.Set(p, c, rgb[c]);
            }
        });
        if (clamped > 0)
            LogWarning(
                "{} pixel values are above {}, the largest of half precision, and are cut to it; "
                "\"bool savefp16\" false keeps them.",
                clamped, kMaxHalf);
        if (counts_.rejected > 0)
            LogWarning(
                "{} samples were dropped: their radiance is not a number, or too large for single precision ({:.2g}).",
                counts_.rejected, std::numeric_limits<Float>::max());
        return image;
    }

  private:
    static constexpr double kBytesPerPixel = 4 * sizeof(PreciseSum) + 3 * sizeof(float);
    RgbFilm(const std::string &kind, const FilmFrame &frame, Float maxComponent, const PixelSensor &sensor)
        : Film(kind, frame), maxComponent_(maxComponent), sensor_(sensor),
          outputFromSensor_(frame.outputSpace->RgbFromXyz() * sensor_.XyzFromSensor()), pixels_(frame.PixelCount()) {}
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
    Point2i Resolution() const { return PixelBounds().high - PixelBounds().low; }
    /// Output colour in float precision.
    Rgb ColorOf(size_t pixel) const {
        const Pixel &sums = pixels_[pixel];
        const double weight = sums.weight.Value(), scale = weight != 0 ? 1 / weight : 0;
        Vector3 sensor;
        for (int c = 0; c < 3; ++c) {
            double mean = sums.sensor[c].Value() * scale;
            if (splats_.AreExpected()) mean += splats_.Sum(3 * pixel + c) * SplatScale();
            sensor[c] = Float(mean);
        }
        return outputFromSensor_ * sensor;
    }
    Float maxComponent_;
    PixelSensor sensor_;
    glm::mat3 outputFromSensor_;
    std::vector<Pixel> pixels_;
    Splats splats_;
    Counts counts_;
};

}  // namespace pbrt
