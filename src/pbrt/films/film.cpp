#include "pbrt/films/film.h"

#include <algorithm>
#include <cmath>

#include "pbrt/films/aov_film.h"
#include "pbrt/films/gbuffer_film.h"
#include "pbrt/films/rgb_film.h"
#include "pbrt/films/spectral_film.h"

namespace pbrt {
namespace {
bool HasSplats(const std::vector<StateBlock> &blocks) {
    return std::ranges::any_of(blocks, [](const StateBlock &b) { return b.isOfSplats && b.bytes > 0; });
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

/// True if all doubles among the sums are finite. Counts never have such bits; splat sums, which may have any bits, are
/// excluded.
static bool AreFinite(std::string_view sums) {
    bool areFinite = true;
    for (size_t at = 0; at + sizeof(double) <= sums.size(); at += sizeof(double)) {
        double value = 0;
        std::memcpy(&value, sums.data() + at, sizeof(value));
        areFinite = areFinite && std::isfinite(value);
    }
    return areFinite;
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
