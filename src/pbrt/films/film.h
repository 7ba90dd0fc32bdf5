#pragma once
#include <atomic>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/films/filter.h"
#include "pbrt/films/sensor.h"
#include "pbrt/images/image.h"
#include "pbrt/math/bounds.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Command line settings that beat the scene's film parameters.
struct FilmOverrides {
    std::optional<Bounds2> cropWindow;       ///< fractions
    std::optional<Bounds2i> pixelBounds;
    std::string filename;                    ///< empty: the scene's
    int resolutionDivisor = 1;               ///< 4 with --quick
    bool fullFloat = false;                  ///< float precision whatever savefp16 says
};

enum class FilmKind { Rgb, GBuffer, Spectral };

/// The `rgb` film: weighted sums per pixel in double precision, so that the order of samples of different pixels never
/// matters. Samples of one pixel are added by one thread at a time. The other films are this and more; adding samples
/// is not virtual: the render loop asks Kind() and calls that film's own SampleWavelengths and AddSample.
class RgbFilm {
  public:
    RgbFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime, const FilmOverrides &overrides,
            DiagnosticSink &sink)
        : RgbFilm(FilmKind::Rgb, params, outputSpace, exposureTime, overrides, sink, 0) {}
    virtual ~RgbFilm() = default;

    FilmKind Kind() const { return kind_; }
    Point2i FullResolution() const { return fullResolution_; }
    const Bounds2i &PixelBounds() const { return pixelBounds_; }
    const std::string &Filename() const { return filename_; }
    Float DiagonalMm() const { return diagonal_; }
    const ColorSpace &OutputSpace() const { return *space_; }

    SampledWavelengths SampleWavelengths(Float u) const { return SampledWavelengths::SampleVisible(u); }
    /// Radiance L along one camera path into one pixel. Not-finite radiance is counted, reported and dropped.
    void AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);

    /// Linear RGB in the output space, over PixelBounds; R, G, B are the first channels of every film. Half precision
    /// if savefp16.
    virtual Image ToImage() const;
    virtual ImageMetadata Metadata() const;
    uint64_t RejectedSamples() const { return rejected_; }

    /// The RGB sums themselves, bit by bit, in this machine's byte order: a render that goes on from them later ends
    /// with the same image. LoadState throws UserError if the state is of other pixel bounds or incomplete.
    void SaveState(std::ostream &out) const;
    void LoadState(std::istream &in);

  protected:
    /// `furtherBytes`: of memory that the derived film needs for a pixel.
    RgbFilm(FilmKind kind, const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
            const FilmOverrides &overrides, DiagnosticSink &sink, double furtherBytes);

    size_t IndexOf(Point2i pixel) const {
        Point2i p = pixel - pixelBounds_.low;
        return static_cast<size_t>(p.y) * static_cast<size_t>(pixelBounds_.Width()) + static_cast<size_t>(p.x);
    }
    size_t PixelCount() const { return pixels_.size(); }
    /// What the sensor reads, cut to maxcomponentvalue. False: not finite; the sample is counted as rejected.
    bool Measure(const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight, Vector3 *sensor);
    void AddToSums(size_t index, const Vector3 &sensor, Float weight) {
        Pixel &sums = pixels_[index];
        for (int c = 0; c < 3; ++c)
            sums.sensor[c] += double(weight) * double(sensor[c]);
        sums.weight += double(weight);
    }
    Float MaxComponentValue() const { return maxComponent_; }
    double WeightOf(size_t index) const { return pixels_[index].weight; }
    /// An image with R, G, B filled and further channels for the derived film to fill; reports what was cut or dropped.
    Image MakeImage(const std::vector<std::string> &furtherChannels) const;

  private:
    struct Pixel {
        double sensor[3] = {0, 0, 0};  ///< sum of weight * XYZ or camera RGB
        double weight = 0;
    };
    FilmKind kind_;
    Point2i fullResolution_{};
    Bounds2i pixelBounds_{};
    std::string filename_;
    Float diagonal_ = 35, maxComponent_ = Infinity;
    bool half_ = true;
    const ColorSpace *space_;
    PixelSensor sensor_;
    glm::mat3 outputFromSensor_{1};
    std::vector<Pixel> pixels_;
    std::atomic<uint64_t> rejected_{0};
};

inline bool RgbFilm::Measure(const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight,
                             Vector3 *sensor) {
    *sensor = sensor_.Expose(SafeDivide(L, lambda.Pdf()), lambda);
    if (!std::isfinite(sensor->x + sensor->y + sensor->z) || !std::isfinite(weight)) {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    Float largest = MaxComponent(*sensor);
    if (largest > maxComponent_) *sensor *= maxComponent_ / largest;
    return true;
}

/// By type name (pbrt-v4-format §5.2). Throws UserError.
std::unique_ptr<RgbFilm> MakeFilm(const std::string &type, const ParamSet &params, const ColorSpace &outputSpace,
                                  Float exposureTime, const FilmOverrides &overrides, DiagnosticSink &sink);
const std::vector<std::string> &SupportedFilms();

}  // namespace pbrt
