#include "pbrt/films/film.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pbrt/core/files.h"
#include "pbrt/core/memory.h"
#include "pbrt/films/aov_film.h"
#include "pbrt/films/gbuffer_film.h"
#include "pbrt/films/rgb_film.h"
#include "pbrt/films/spectral_film.h"

namespace pbrt {
namespace {

constexpr const char *kOtherFilm = "its sums are of another film";

/// A loaded state: kind and pixels of the film, and its sums by name.
struct SavedState {
    std::string kind;
    Bounds2i pixelBounds{};
    std::map<std::string, std::string_view> sums;  ///< the reader's bytes
};

constexpr std::array<char, 8> kMagic = {'p', 'b', 'r', 't', 'f', 'l', 'm', '3'};  // the last byte is the version

/// Throws UserError for truncated or other data.
SavedState ReadState(StateReader &in) {
    SavedState state;
    const auto magic = in.Value<std::array<char, 8>>();
    in.Require(std::equal(kMagic.begin(), kMagic.end() - 1, magic.begin()), kOtherFilm);
    in.Require(magic == kMagic, "its film is of another version of the program");
    in(state.kind, state.pixelBounds);
    for (auto count = in.Value<uint64_t>(); count > 0; --count) {
        const std::string name = in.Text();
        state.sums[name] = in.Take(in.Value<uint64_t>());
    }
    return state;
}

bool HasSplats(const std::vector<StateBlock> &blocks) {
    return std::ranges::any_of(blocks, [](const StateBlock &b) { return b.isOfSplats && b.bytes > 0; });
}

/// True if all doubles among the sums are finite. Counts never have such bits; splat sums may, and are excluded.
bool AreFinite(std::string_view sums) {
    for (size_t at = 0; at + sizeof(double) <= sums.size(); at += sizeof(double)) {
        double value = 0;
        std::memcpy(&value, sums.data() + at, sizeof(value));
        if (!std::isfinite(value)) return false;
    }
    return true;
}

Bounds2i FromCropWindow(const Bounds2 &window, Point2i resolution) {
    auto pixel = [](Float fraction, int extent) {
        return int(std::ceil(Float(extent) * std::clamp(fraction, Float(-1), Float(2))));
    };
    Point2 low = glm::min(window.low, window.high), high = glm::max(window.low, window.high);
    return {{pixel(low.x, resolution.x), pixel(low.y, resolution.y)},
            {pixel(high.x, resolution.x), pixel(high.y, resolution.y)}};
}

/// Rendered pixels. The command line overrides the scene; in both, a crop window overrides pixel bounds. Bounds outside
/// the image are clipped with a warning; an empty result is an error. Pixel bounds of the scene refer to its
/// resolution: they shrink with --quick, rounded outwards.
Bounds2i ChoosePixelBounds(const FilmParams &params, const ParamSet &set, Point2i fullResolution,
                           const FilmOverrides &overrides, DiagnosticSink &sink) {
    const Bounds2i full{{0, 0}, fullResolution};
    const bool isByFlag = overrides.cropWindow || overrides.pixelBounds;
    const FileLoc loc = isByFlag ? FileLoc() : set.LocOf(params.cropWindow ? "cropwindow" : "pixelbounds");

    Bounds2i bounds = full, wanted = full;
    auto take = [&](const Bounds2i &given) {
        wanted = {glm::min(given.low, given.high), glm::max(given.low, given.high)};
        bounds = Intersect(wanted, full);
        if (!bounds.IsEmpty() && (bounds.low != wanted.low || bounds.high != wanted.high))
            sink.Warning(loc, "The pixel bounds reach beyond the image and are cut.");
    };
    if (overrides.cropWindow) take(FromCropWindow(*overrides.cropWindow, fullResolution));
    else if (overrides.pixelBounds) take(*overrides.pixelBounds);
    else if (const auto &v = params.cropWindow) {
        if (params.pixelBounds)
            sink.Warning(loc, "Both a crop window and pixel bounds are given; the crop window counts.");
        take(FromCropWindow({{(*v)[0], (*v)[2]}, {(*v)[1], (*v)[3]}}, fullResolution));
    } else if (const auto &b = params.pixelBounds) {
        const int d = overrides.resolutionDivisor;
        take({{(*b)[0] / d, (*b)[2] / d}, {(*b)[1] / d + ((*b)[1] % d > 0), (*b)[3] / d + ((*b)[3] % d > 0)}});
    }
    if (bounds.IsEmpty())
        throw UserError(loc, "{}No pixel is left to render: pixel bounds x {} to {}, y {} to {} of {} x {} pixels.",
                        isByFlag ? "command line: " : "", wanted.low.x, wanted.high.x, wanted.low.y, wanted.high.y,
                        fullResolution.x, fullResolution.y);
    return bounds;
}

}  // namespace

const FilmTable &Films() {
    static const FilmTable table("Film", [](FilmTable &t) {
        t.Add<FilmParams>("rgb", "all 18 sensors", [](const auto &p, const ParamSet &set, auto &r) {
            return std::make_unique<RgbFilm>(p, set, r);
        });
        t.Add<GBufferParams>(
            "gbuffer", "**differs**: [departures](#departures)",
            [](const auto &p, const ParamSet &set, auto &r) { return std::make_unique<GBufferFilm>(p, set, r); });
        t.Add<SpectralParams>(
            "spectral", "**differs** at dispersive surfaces: [departures](#departures)",
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
    CheckImageName(frame.filename, loc);
    if (onlyExr && LowerExtension(frame.filename) != ".exr")
        throw UserError(loc, "\"{}\": the channels of this film only fit into an .exr file.", frame.filename);
    frame.diagonalMm = params.diagonalMm;
    frame.half = params.half && !overrides.fullFloat;
    const Bounds2i &bounds = frame.pixelBounds;
    RequireMemory(double(bounds.Area()) * bytesPerPixel,
                  fmt::format("{}: an image of {} x {} pixels", set.What(), bounds.Width(), bounds.Height()),
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

Image Film::PixelsIn(const ImageFile &file, const std::string &path) const {
    const Bounds2i all{{0, 0}, file.image.Resolution()}, has = file.metadata.pixelBounds.value_or(all);
    const Point2i full = file.metadata.fullResolution.value_or(all.high), needed = FullResolution();
    const auto &[low, high] = PixelBounds();
    if (full != needed || Intersect(PixelBounds(), has) != PixelBounds())
        throw UserError(
            "{}: the reference has x {}-{}, y {}-{} of {} x {} pixels; the film needs x {}-{}, y {}-{} of {} x {}.",
            path, has.low.x, has.high.x, has.low.y, has.high.y, full.x, full.y, low.x, high.x, low.y, high.y, needed.x,
            needed.y);
    return file.image.Select({"R", "G", "B"}, path + ":").Crop({low - has.low, high - has.low});
}

void Film::Save(StateWriter &out) const {
    const std::vector<StateBlock> blocks = Blocks();
    out(kMagic, kind_, PixelBounds(), uint64_t{blocks.size()});
    for (const StateBlock &block : blocks) {
        out(block.name, uint64_t{block.bytes});
        out.Refer(block.data, block.bytes);
    }
}

void Film::TakeSums(StateWriter &out) {
    // The receiving film must allocate splats before it reads the sums.
    const std::vector<StateBlock> blocks = Blocks();
    out.Value(HasSplats(blocks));
    for (const StateBlock &block : blocks) {
        // Compared in pieces of several sums; adjacent pieces form one run.
        const size_t piece = std::max<size_t>(1, 256 / block.sumBytes) * block.sumBytes;
        std::vector<std::byte> empty(std::min(piece, block.bytes));
        block.clear(empty.data(), empty.size());
        const auto isEmpty = [&](size_t at) {
            return std::memcmp(block.data + at, empty.data(), std::min(piece, block.bytes - at)) == 0;
        };
        out.Value(uint64_t{block.bytes});
        for (size_t at = 0; at < block.bytes;) {
            if (isEmpty(at)) {
                at += piece;
                continue;
            }
            const size_t begin = at;
            while (at < block.bytes && !isEmpty(at)) at += piece;
            const size_t bytes = std::min(at, block.bytes) - begin;
            out(uint64_t{begin}, uint64_t{bytes});
            out.Copy(block.data + begin, bytes);
        }
        out.Value(uint64_t{block.bytes});
        block.clear(block.data, block.bytes);
    }
}

void Film::AddSums(StateReader &in) {
    if (in.Value<bool>() && !HasSplats(Blocks())) ExpectSplats();
    for (const StateBlock &block : Blocks()) {
        const auto all = in.Value<uint64_t>();
        in.Require(all == block.bytes || (block.isOfSplats && all == 0), kOtherFilm);
        for (auto begin = in.Value<uint64_t>(); begin < all; begin = in.Value<uint64_t>()) {
            const auto bytes = in.Value<uint64_t>();
            in.Require(bytes <= all - begin && begin % block.sumBytes == 0 && bytes % block.sumBytes == 0, kOtherFilm);
            block.add(block.data + begin, reinterpret_cast<const std::byte *>(in.Take(bytes).data()), bytes);
        }
    }
}

void Film::Add(StateReader &in, bool forgetsFirst) {
    const SavedState state = ReadState(in);
    std::vector<StateBlock> blocks = Blocks();
    const auto isSaved = [&](const StateBlock &block) { return state.sums.contains(block.name); };
    in.Require(state.kind == kind_ && state.pixelBounds.low == PixelBounds().low &&
                   state.pixelBounds.high == PixelBounds().high && std::ranges::all_of(blocks, isSaved),
               kOtherFilm);
    const auto lacksRoom = [&](const StateBlock &block) {
        return block.isOfSplats && block.bytes == 0 && !state.sums.at(block.name).empty();
    };
    if (std::ranges::any_of(blocks, lacksRoom)) {
        ExpectSplats();
        blocks = Blocks();
    }
    for (const StateBlock &block : blocks) {
        const std::string_view saved = state.sums.at(block.name);
        in.Require(saved.size() == block.bytes || (block.isOfSplats && saved.empty()), kOtherFilm);
        in.Require(block.isOfSplats || AreFinite(saved), "its film has sums that are not finite");
    }
    for (const StateBlock &block : blocks) {
        const std::string_view saved = state.sums.at(block.name);
        if (forgetsFirst) block.clear(block.data, block.bytes);
        block.add(block.data, reinterpret_cast<const std::byte *>(saved.data()), saved.size());
    }
}

}  // namespace pbrt
