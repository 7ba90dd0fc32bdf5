#pragma once
#include <atomic>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/films/filter.h"
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

/// The `rgb` film: weighted sums per pixel in double precision, so that the order of samples of different pixels never
/// matters. Samples of one pixel are added by one thread at a time.
class RgbFilm {
  public:
    RgbFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime, const FilmOverrides &overrides,
            DiagnosticSink &sink);

    Point2i FullResolution() const { return fullResolution_; }
    const Bounds2i &PixelBounds() const { return pixelBounds_; }
    const std::string &Filename() const { return filename_; }
    Float DiagonalMm() const { return diagonal_; }
    const ColorSpace &OutputSpace() const { return *space_; }

    SampledWavelengths SampleWavelengths(Float u) const { return SampledWavelengths::SampleVisible(u); }
    /// Radiance L along one camera path into one pixel. Not-finite radiance is counted, reported and dropped.
    void AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);

    /// Linear RGB in the output space, over PixelBounds. Half precision if savefp16.
    Image ToImage() const;
    ImageMetadata Metadata() const;
    uint64_t RejectedSamples() const { return rejected_; }

    /// The sums themselves, bit by bit, in this machine's byte order: a render that goes on from them later ends with the
    /// same image. LoadState throws UserError if the state is of other pixel bounds or incomplete.
    void SaveState(std::ostream &out) const;
    void LoadState(std::istream &in);

  private:
    struct Pixel {
        double sensor[3] = {0, 0, 0};  ///< sum of weight * XYZ
        double weight = 0;
    };
    Point2i fullResolution_{};
    Bounds2i pixelBounds_{};
    std::string filename_;
    Float diagonal_ = 35, maxComponent_ = Infinity, imagingRatio_ = 1;
    bool half_ = true;
    const ColorSpace *space_;
    glm::mat3 outputFromSensor_{1};
    std::vector<Pixel> pixels_;
    std::atomic<uint64_t> rejected_{0};
};

const std::vector<std::string> &SupportedFilms();
const std::vector<std::string> &UnsupportedFilms();
/// Camera sensors of the format; cie1931 is the one that is supported.
const std::vector<std::string> &UnsupportedSensors();

}  // namespace pbrt
