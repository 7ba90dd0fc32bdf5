#pragma once
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/state_io.h"
#include "pbrt/films/sensor.h"
#include "pbrt/images/image.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/math/vec.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

struct FilmParams {
    std::string filename = "pbrt.exr";
    int xResolution = 1280, yResolution = 720;
    std::optional<std::array<Float, 4>> cropWindow;
    std::optional<std::array<int, 4>> pixelBounds;
    Float diagonalMm = 35, maxComponentValue = Infinity;
    bool half = true;
    SensorParams sensor;

    void Describe(auto &&v) {
        v("filename", filename, "image file; --outfile overrides it");
        v("xresolution", xResolution, Range<int>{1, kMaxImageSide, false, false, "pixels"}, "width");
        v("yresolution", yResolution, Range<int>{1, kMaxImageSide, false, false, "pixels"}, "height");
        v("cropwindow", cropWindow, "rendered x0 x1 y0 y1 as fractions; overridden by --cropwindow, --pixelbounds");
        v("pixelbounds", pixelBounds, "rendered x0 x1 y0 y1 in pixels; overridden by cropwindow");
        v("diagonal", diagonalMm, Positive(1e6f, "mm"), "film diagonal, for realistic cameras");
        sensor.Describe(v);
        v("maxcomponentvalue", maxComponentValue, Positive(std::numeric_limits<Float>::max()),
          "brighter samples and splats are scaled down to this");
        v("savefp16", half, "write half-precision floats");
    }
};

struct FilmOverrides {
    std::optional<Bounds2> cropWindow;  ///< fractions
    std::optional<Bounds2i> pixelBounds;
    std::string filename;             ///< empty: the scene's
    int resolutionDivisor = 1;        ///< 4 with --quick
    bool fullFloat = false;           ///< float precision regardless of savefp16
    std::vector<std::string> aovs{};  ///< --aov: names of additional channels

    void Visit(auto &archive) { archive(cropWindow, pixelBounds, filename, resolutionDivisor, fullFloat, aovs); }
};

/// Properties common to all films: size, and output format.
struct FilmFrame {
    Point2i fullResolution{};
    Bounds2i pixelBounds{};  ///< rendered pixels
    std::string filename;
    Float diagonalMm = 35;
    bool half = true;  ///< half-precision output
    const ColorSpace *outputSpace = nullptr;

    size_t PixelCount() const { return pixelBounds.Area(); }
    /// Pixel count of the full image.
    double FullPixels() const { return double(fullResolution.x) * double(fullResolution.y); }
    size_t IndexOf(Point2i pixel) const {
        PBRT_DCHECK(pixelBounds.Contains(pixel));
        const Point2i p = pixel - pixelBounds.low;
        return size_t(p.y) * pixelBounds.Width() + p.x;
    }
};

/// Sums of one type as plain memory, with functions to add and clear them.
struct StateBlock {
    std::string name;
    std::byte *data = nullptr;
    size_t bytes = 0;
    size_t sumBytes = 1;      ///< of one sum
    bool isOfSplats = false;  ///< has no bytes in a film without splats
    void (*add)(std::byte *to, const std::byte *from, size_t bytes) = nullptr;
    void (*clear)(std::byte *data, size_t bytes) = nullptr;
};

/// T is plain memory, T() an empty sum, and T += T adds. An empty sum plus another is bit-identical to the other.
template <class T>
StateBlock MakeStateBlock(const char *name, std::span<const T> sums) {
    static_assert(std::is_trivially_copyable_v<T>);
    auto *memory = const_cast<std::byte *>(reinterpret_cast<const std::byte *>(sums.data()));
    StateBlock block{.name = name, .data = memory, .bytes = sums.size_bytes(), .sumBytes = sizeof(T)};
    block.add = [](std::byte *to, const std::byte *from, size_t bytes) {
        for (size_t at = 0; at < bytes; at += sizeof(T)) {
            T sum, other;
            std::memcpy(&sum, to + at, sizeof(T));
            std::memcpy(&other, from + at, sizeof(T));
            sum += other;
            std::memcpy(to + at, &sum, sizeof(T));
        }
    };
    block.clear = [](std::byte *data, size_t bytes) {
        const T empty{};
        for (size_t at = 0; at < bytes; at += sizeof(T)) std::memcpy(data + at, &empty, sizeof(T));
    };
    return block;
}

/// First scattering surface along a camera ray, in rendering space.
struct VisibleSurface {
    Point3 p{};
    Normal3 n{}, ns{};  ///< unit, geometric and shading, facing the camera
    Point2 uv{};
    Vector3 dpdx{}, dpdy{};  ///< derivatives of p over the filter footprint
    Float time = 0;          ///< of the ray
    SampledSpectrum albedo;  ///< at `lambda`
    SampledWavelengths lambda;
};

/// Colour of the space's white after one reflection at the surface.
Rgb AlbedoColor(const VisibleSurface &visible, const ColorSpace &space);

/// Mean normals of pixels without a surface are zero.
inline glm::dvec3 UnitOrZero(const glm::dvec3 &v) { return glm::dot(v, v) > 0 ? glm::normalize(v) : glm::dvec3(0); }

struct FilmSample {
    Point2i pixel{};
    SampledSpectrum L;  ///< radiance at `lambda`
    SampledWavelengths lambda;
    Float weight = 1;                       ///< filter weight
    std::optional<VisibleSurface> visible;  ///< only if the film needs it; empty: no surface is hit
    bool hasRay = true;                     ///< false: the camera has no ray for the sample (stopped by the lens)
};

/// Accumulates samples and splats per pixel. Sums are in double-double precision (PreciseSum), so that the order of
/// samples and their distribution over merged films do not matter.
class Film {
  public:
    virtual ~Film() = default;

    Point2i FullResolution() const { return frame_.fullResolution; }
    /// 1 / pixels of the full image: the factor of CameraConnection::weight for a splat.
    Float SplatUnit() const { return Float(1 / frame_.FullPixels()); }
    const Bounds2i &PixelBounds() const { return frame_.pixelBounds; }
    /// R, G, B of this film's pixels in a file. Throws UserError if it lacks some, or is of another full resolution.
    Image PixelsIn(const ImageFile &file, const std::string &path) const;
    const std::string &Filename() const { return frame_.filename; }
    Float DiagonalMm() const { return frame_.diagonalMm; }
    const ColorSpace &OutputSpace() const { return *frame_.outputSpace; }

    virtual SampledWavelengths SampleWavelengths(Float u) const { return SampledWavelengths::SampleVisible(u); }
    virtual bool NeedsVisibleSurface() const { return false; }
    /// One thread at a time per pixel, in the same order for any threads. Reports and drops non-finite radiance.
    virtual void AddSample(const FilmSample &sample) = 0;

    /// Allocates the splat buffer. To be called on one thread before the first splat.
    virtual void ExpectSplats() = 0;
    /// Adds `weight` times the radiance to a pixel, for light that reached it by any path. Units match samples: as many
    /// paths as the full image has pixels equal one sample in every pixel. Thread-safe and bit-identical in any order
    /// (FixedSum). Ignored outside PixelBounds(). Non-finite values and those beyond FixedSum's range are counted,
    /// reported and dropped.
    virtual void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) = 0;
    /// Adds to the number of paths behind the splats, anywhere on the film. The splat sum is divided by it and
    /// multiplied by the full image's pixel count.
    virtual void AddSplatPaths(uint64_t paths) = 0;

    /// Linear RGB in the output space, over PixelBounds(); R, G, B are the first channels of every film. Half precision
    /// if savefp16.
    virtual Image ToImage() const = 0;
    /// R, G and B of ToImage in float precision without messages, for previews.
    virtual Image Colors() const = 0;
    virtual ImageMetadata Metadata() const {
        ImageMetadata metadata;
        metadata.pixelBounds = frame_.pixelBounds;
        metadata.fullResolution = frame_.fullResolution;
        metadata.colorSpace = frame_.outputSpace;
        return metadata;
    }
    virtual uint64_t RejectedSamples() const = 0;
    size_t Bytes() const {
        size_t bytes = 0;
        for (const StateBlock &block : Blocks()) bytes += block.bytes;
        return bytes;
    }
    /// Creates an empty rgb film of the same pixels and sensor, in float precision.
    virtual std::unique_ptr<Film> MakeRgbFilm() const = 0;

    /// Save writes all sums bitwise, in native byte order; the writer refers to them. A film that loads them continues
    /// identically. Merge adds them as if both films' samples had been added to one, bit-identical in any order as far
    /// as PreciseSum is exact. Load and Merge throw UserError, without a change, if the state is incomplete or of
    /// another kind of film or other pixels.
    void Save(StateWriter &out) const;
    void Load(StateReader &in) { Add(in, true); }
    void Merge(StateReader &in) { Add(in, false); }
    /// Transfer of sums between processes for films of the same kind and pixels: Take writes and clears the non-empty
    /// ones, Add merges them.
    void TakeSums(StateWriter &out);
    void AddSums(StateReader &in);

  protected:
    Film(std::string kind, FilmFrame frame) : kind_(std::move(kind)), frame_(std::move(frame)) {}
    const FilmFrame &Frame() const { return frame_; }

  private:
    friend class AovFilm;  // wraps another film
    virtual std::vector<StateBlock> Blocks() const = 0;
    /// Adds a saved state, clearing the sums first if `forgetsFirst`. Throws UserError if it is of another film.
    void Add(StateReader &in, bool forgetsFirst);
    std::string kind_;
    FilmFrame frame_;
};

struct FilmContext {
    const ColorSpace &outputSpace;
    Float exposureTime = 1;  ///< seconds
    FilmOverrides overrides{};
    AnimatedTransform renderFromCamera{};
    Transform renderFromWorld{};
};

struct FilmRequest {
    const FilmContext &context;
    DiagnosticSink &sink;
    /// `set`: source of the parameters. `onlyExr`: other formats cannot hold the channels. `bytesPerPixel`: of sums and
    /// output image. Throws UserError, also if memory is insufficient.
    FilmFrame Frame(const FilmParams &params, const ParamSet &set, bool onlyExr, double bytesPerPixel) const;
};

using FilmTable = FactoryTable<std::unique_ptr<Film>, const FilmRequest>;
const FilmTable &Films();
/// Adds the channels of FilmOverrides::aovs. Throws UserError.
std::unique_ptr<Film> MakeFilm(const std::string &type, const ParamSet &params, const FilmContext &context,
                               DiagnosticSink &sink);

}  // namespace pbrt
