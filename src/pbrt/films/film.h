#pragma once
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/factory_table.h"
#include "pbrt/films/film_frame.h"
#include "pbrt/films/film_state.h"
#include "pbrt/films/visible_surface.h"
#include "pbrt/images/image.h"
#include "pbrt/math/animated_transform.h"

namespace pbrt {

/// The result of one camera path.
struct FilmSample {
    Point2i pixel{};
    SampledSpectrum L;  ///< radiance at `lambda`
    SampledWavelengths lambda;
    Float weight = 1;                       ///< of the filter
    std::optional<VisibleSurface> visible;  ///< only for films that want it; empty: no surface is seen
    bool hasRay = true;                     ///< false: the camera has no ray for the sample, which the lens stops
};

/// Sums up what is measured in every pixel, and makes the picture. Sums are kept per pixel and in twice double
/// precision (PreciseSum), so that neither the order of samples matters nor how they are divided among films that are
/// merged.
class Film {
  public:
    virtual ~Film() = default;

    Point2i FullResolution() const { return frame_.fullResolution; }
    /// One by the number of pixels of the whole picture: what CameraConnection::weight is multiplied by for a splat.
    Float SplatUnit() const { return static_cast<Float>(1 / frame_.FullPixels()); }
    const Bounds2i &PixelBounds() const { return frame_.pixelBounds; }
    const std::string &Filename() const { return frame_.filename; }
    Float DiagonalMm() const { return frame_.diagonalMm; }
    const ColorSpace &OutputSpace() const { return *frame_.outputSpace; }

    virtual SampledWavelengths SampleWavelengths(Float u) const { return SampledWavelengths::SampleVisible(u); }
    /// True if samples need the surface that the camera sees (FilmSample::visible).
    virtual bool WantsVisibleSurface() const { return false; }
    /// Samples of one pixel are added by one thread at a time, in an order that does not depend on the threads.
    /// Not-finite radiance is counted, reported and dropped.
    virtual void AddSample(const FilmSample &sample) = 0;

    /// Makes room for splats. To be called on one thread before the first splat.
    virtual void ExpectSplats() = 0;
    /// Light that reached a pixel by any path: `weight` times the radiance is added. The unit is that of samples: paths
    /// that end all over the whole picture, as many as it has pixels, make what one sample makes in every pixel. From
    /// any thread; the sum is the same to the bit in any order (FixedSum). Outside PixelBounds() nothing happens. What
    /// is not finite, or larger than FixedSum holds, is counted, reported and dropped.
    virtual void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) = 0;
    /// Adds to the number of paths that the splats come from, wherever on the film they are. The picture gets the sum
    /// of splats divided by it and multiplied by the number of pixels of the whole picture.
    virtual void AddSplatPaths(uint64_t paths) = 0;

    /// Linear RGB in the output space, over PixelBounds(); R, G, B are the first channels of every film. Half precision
    /// if savefp16.
    virtual Image ToImage() const = 0;
    /// R, G and B of ToImage, always in float precision and without messages: for looking at while the picture grows.
    virtual Image Colors() const = 0;
    virtual ImageMetadata Metadata() const;
    virtual uint64_t RejectedSamples() const = 0;
    /// Of the sums.
    size_t Bytes() const;
    /// An empty rgb film of the same pixels and sensor, in float precision.
    virtual std::unique_ptr<Film> MakeRgbFilm() const = 0;

    /// Save writes all sums bit by bit, in this machine's byte order. A film that loads them continues exactly as this
    /// one would. Merge adds them to those of the film, as if the samples of both had been added to one film, to the
    /// bit in any order as far as PreciseSum is exact. Load and Merge throw UserError, and leave the film as it was, if
    /// the state is incomplete or not of a film of this kind and these pixels.
    void Save(std::ostream &out) const;
    /// The same without a copy: the writer refers to the sums of this film.
    void Save(StateWriter &out) const;
    void Load(std::istream &in);
    void Merge(std::istream &in);
    /// Moves sums from a film to another one of the same kind and pixels, in another process: Take writes those that
    /// are not empty and empties them, Add adds them as Merge does.
    void TakeSums(StateWriter &out);
    void AddSums(StateReader &in);

  protected:
    /// `kind`: the name of the film in the scene.
    Film(std::string kind, FilmFrame frame) : kind_(std::move(kind)), frame_(std::move(frame)) {}
    const FilmFrame &Frame() const { return frame_; }
    /// Of another film, for films that add something to one.
    static const FilmFrame &FrameOf(const Film &film) { return film.frame_; }
    static const std::string &KindOf(const Film &film) { return film.kind_; }
    static std::vector<StateBlock> BlocksOf(const Film &film) { return film.Blocks(); }

  private:
    /// All sums as blocks of memory.
    virtual std::vector<StateBlock> Blocks() const = 0;
    /// Adds a saved state, after clearing the sums if `forgetsFirst`. Throws UserError if it is not of this film.
    void Add(std::istream &in, bool forgetsFirst);
    std::string kind_;
    FilmFrame frame_;
};

/// What a film is made from beside its parameters.
struct FilmContext {
    const ColorSpace &outputSpace;
    Float exposureTime = 1;  ///< seconds
    FilmOverrides overrides{};
    /// For films that record positions and normals.
    AnimatedTransform renderFromCamera{};
    Transform renderFromWorld{};
};

/// The context of a film that is being made, and the sink of its warnings.
struct FilmRequest {
    const FilmContext &context;
    DiagnosticSink &sink;
    /// Throws UserError.
    FilmFrame Frame(const FilmParams &params, const ParamSet &set, const FrameNeeds &needs) const {
        return MakeFilmFrame(params, set, context.outputSpace, context.overrides, needs, sink);
    }
};

using FilmTable = FactoryTable<std::unique_ptr<Film>, const FilmRequest>;
const FilmTable &Films();
/// With the channels of FilmOverrides::aovs added. Throws UserError.
std::unique_ptr<Film> MakeFilm(const std::string &type, const ParamSet &params, const FilmContext &context,
                               DiagnosticSink &sink);

}  // namespace pbrt
