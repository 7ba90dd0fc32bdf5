#include "pbrt/films/film.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/files.h"
#include "pbrt/core/memory.h"
#include "pbrt/films/aov_film.h"
#include "pbrt/films/gbuffer_film.h"
#include "pbrt/films/rgb_film.h"
#include "pbrt/films/spectral_film.h"

namespace pbrt {
namespace {

bool HasSplats(const std::vector<StateBlock> &blocks) {
    return std::ranges::any_of(blocks, [](const StateBlock &b) { return b.isOfSplats && b.bytes > 0; });
}

/// True if all doubles among the sums are finite. Counts never have such bits; splat sums, which may have any bits, are
/// excluded.
bool AreFinite(std::string_view sums) {
    bool areFinite = true;
    for (size_t at = 0; at + sizeof(double) <= sums.size(); at += sizeof(double)) {
        double value = 0;
        std::memcpy(&value, sums.data() + at, sizeof(value));
        areFinite = areFinite && std::isfinite(value);
    }
    return areFinite;
}

/// Scales the scene's pixel bounds by 1 / `divisor`, rounded outwards.
Bounds2i Shrunk(const std::array<int, 4> &v, int divisor) {
    auto shrink = [&](int i) { return i / divisor; };
    return Bounds2i{{shrink(v[0]), shrink(v[2])}, {shrink(v[1] + divisor - 1), shrink(v[3] + divisor - 1)}};
}

Bounds2i FromCropWindow(const Bounds2 &window, Point2i resolution) {
    auto pixel = [](Float fraction, int extent) {
        return int(std::ceil(Float(extent) * std::clamp(fraction, Float(0), Float(1))));
    };
    Point2 low = glm::min(window.low, window.high), high = glm::max(window.low, window.high);
    return {{pixel(low.x, resolution.x), pixel(low.y, resolution.y)},
            {pixel(high.x, resolution.x), pixel(high.y, resolution.y)}};
}

/// Rendered pixels. The command line overrides the scene; in both, a crop window overrides pixel bounds. Bounds outside
/// the image are clipped with a warning; an empty result is an error. Pixel bounds of the scene refer to its
/// resolution: they shrink with --quick.
Bounds2i ChoosePixelBounds(const FilmParams &params, const ParamSet &set, Point2i fullResolution,
                           const FilmOverrides &overrides, DiagnosticSink &sink) {
    const Bounds2i full{{0, 0}, fullResolution};
    FileLoc loc = set.LocOf("pixelbounds");

    Bounds2i bounds = full;
    auto take = [&](const Bounds2i &wanted) {
        bounds = Intersect(wanted, full);
        if (!wanted.IsEmpty() && (bounds.low != wanted.low || bounds.high != wanted.high))
            sink.Warning(loc, "The pixel bounds reach beyond the image and are cut.");
    };
    if (overrides.cropWindow) {
        bounds = FromCropWindow(*overrides.cropWindow, fullResolution);
        loc = {};
    } else if (overrides.pixelBounds) {
        loc = {};
        take(*overrides.pixelBounds);
    } else if (const auto &v = params.cropWindow) {
        loc = set.LocOf("cropwindow");
        if (params.pixelBounds)
            sink.Warning(loc, "Both a crop window and pixel bounds are given; the crop window counts.");
        bounds = FromCropWindow({{(*v)[0], (*v)[2]}, {(*v)[1], (*v)[3]}}, fullResolution);
    } else if (params.pixelBounds) {
        take(Shrunk(*params.pixelBounds, overrides.resolutionDivisor));
    }
    if (bounds.IsEmpty())
        throw UserError(loc, "{}No pixel is left to render: pixel bounds x {} to {}, y {} to {} of {} x {} pixels.",
                        overrides.cropWindow || overrides.pixelBounds ? "command line: " : "", bounds.low.x,
                        bounds.high.x, bounds.low.y, bounds.high.y, fullResolution.x, fullResolution.y);
    return bounds;
}

}  // namespace

const FilmTable &Films() {
    static const FilmTable table("Film", [](FilmTable &t) {
        t.Add<FilmParams>("rgb", "all 18 sensors", [](const auto &p, const ParamSet &set, auto &r) {
            return std::make_unique<RgbFilm>(p, set, r);
        });
        t.Add<GBufferParams>("gbuffer", "**differs**, see below", [](const auto &p, const ParamSet &set, auto &r) {
            return std::make_unique<GBufferFilm>(p, set, r);
        });
        t.Add<SpectralParams>(
            "spectral", "**differs** at dispersive surfaces, see below",
            [](const auto &p, const ParamSet &set, auto &r) { return std::make_unique<SpectralFilm>(p, set, r); });
    });
    return table;
}

FilmFrame FilmRequest::Frame(const FilmParams &params, const ParamSet &set, bool onlyExr, double bytesPerPixel) const {
    const FilmOverrides &overrides = context.overrides;
    FilmFrame frame;
    frame.outputSpace = &context.outputSpace;
    auto shrunk = [&](int extent) { return std::max(1, extent / overrides.resolutionDivisor); };
    frame.fullResolution = {shrunk(params.xResolution), shrunk(params.yResolution)};
    frame.pixelBounds = ChoosePixelBounds(params, set, frame.fullResolution, overrides, sink);
    frame.filename = overrides.filename.empty() ? params.filename : overrides.filename;
    // Before rendering, so that no render is lost.
    const FileLoc loc = overrides.filename.empty() ? set.LocOf("filename") : FileLoc();
    CheckPictureName(frame.filename, loc);
    if (onlyExr && LowerExtension(frame.filename) != ".exr")
        throw UserError(loc, "\"{}\": the channels of this film only fit into an .exr file.", frame.filename);
    frame.diagonalMm = params.diagonalMm;
    frame.half = params.half && !overrides.fullFloat;
    const Bounds2i &bounds = frame.pixelBounds;
    RequireMemory(double(bounds.Area()) * bytesPerPixel,
                  fmt::format("{}: a picture of {} x {} pixels", set.What(), bounds.Width(), bounds.Height()),
                  set.LocOf("xresolution"));
    return frame;
}

std::unique_ptr<Film> MakeFilm(const std::string &type, const ParamSet &params, const FilmContext &context,
                               DiagnosticSink &sink) {
    std::unique_ptr<Film> film = Films().Make(type, params, FilmRequest{context, sink});
    if (context.overrides.aovs.empty()) return film;
    return std::make_unique<AovFilm>(std::move(film), context);
}

Rgb AlbedoColor(const VisibleSurface &visible, const ColorSpace &space) {
    const SampledWavelengths &lambda = visible.lambda;
    const SampledSpectrum reflected = SafeDivide(visible.albedo * space.Illuminant().Sample(lambda), lambda.Pdf());
    const Xyz xyz((reflected * CieX().Sample(lambda)).Average(), (reflected * CieY().Sample(lambda)).Average(),
                  (reflected * CieZ().Sample(lambda)).Average());
    return space.ToRgb(xyz / CieYIntegral);
}

ImageMetadata Film::Metadata() const {
    ImageMetadata metadata;
    metadata.pixelBounds = frame_.pixelBounds;
    metadata.fullResolution = frame_.fullResolution;
    metadata.colorSpace = frame_.outputSpace;
    return metadata;
}

size_t Film::Bytes() const {
    size_t bytes = 0;
    for (const StateBlock &block : Blocks()) bytes += block.bytes;
    return bytes;
}

void Film::TakeSums(StateWriter &out) {
    // The receiving film must allocate splats before it reads the sums.
    const std::vector<StateBlock> blocks = Blocks();
    out.Value(HasSplats(blocks));
    pbrt::TakeSums(out, blocks);
}

void Film::AddSums(StateReader &in) {
    if (in.Value<bool>() && !HasSplats(Blocks())) ExpectSplats();
    pbrt::AddSums(in, Blocks());
}

void Film::Add(StateReader &in, bool forgetsFirst) {
    const SavedState state = ReadState(in);
    std::vector<StateBlock> blocks = Blocks();
    const auto isSaved = [&](const StateBlock &block) { return state.sums.contains(block.name); };
    if (state.kind != kind_ || state.pixelBounds.low != PixelBounds().low ||
        state.pixelBounds.high != PixelBounds().high || !std::ranges::all_of(blocks, isSaved))
        ThrowOtherFilm();
    const auto lacksRoom = [&](const StateBlock &block) {
        return block.isOfSplats && block.bytes == 0 && !state.sums.at(block.name).empty();
    };
    if (std::ranges::any_of(blocks, lacksRoom)) {
        ExpectSplats();
        blocks = Blocks();
    }
    for (const StateBlock &block : blocks) {
        const std::string_view saved = state.sums.at(block.name);
        if (saved.size() != block.bytes && !(block.isOfSplats && saved.empty())) ThrowOtherFilm();
        if (!block.isOfSplats && !AreFinite(saved))
            throw UserError("the saved state of a film has sums that are not finite.");
    }
    for (const StateBlock &block : blocks) {
        const std::string_view saved = state.sums.at(block.name);
        if (forgetsFirst) block.clear(block.Memory(), block.bytes);
        block.add(block.Memory(), reinterpret_cast<const std::byte *>(saved.data()), saved.size());
    }
}

}  // namespace pbrt
