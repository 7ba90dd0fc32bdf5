#pragma once
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/memory.h"
#include "pbrt/films/film.h"
#include "pbrt/math/statistics.h"

namespace pbrt {

/// Auxiliary output, mostly of the first visible surface, available for any film.
struct Aov {
    const char *name;                    ///< in --aov
    std::vector<const char *> channels;  ///< as in the gbuffer film, where it has them
    const char *help;
};
/// All AOVs in channel order, that of the film's enumeration.
inline const std::vector<Aov> &Aovs() {
    static const std::vector<Aov> all = {
        {"albedo", {"Albedo.R", "Albedo.G", "Albedo.B"}, "colour of the surface; black where nothing is seen"},
        {"normal", {"Ns.X", "Ns.Y", "Ns.Z"}, "shading normal"},
        {"geonormal", {"N.X", "N.Y", "N.Z"}, "geometric normal"},
        {"position", {"P.X", "P.Y", "P.Z"}, "position"},
        {"depth", {"Z"}, "distance along the viewing direction"},
        {"uv", {"u", "v"}, "surface coordinates"},
        {"samples", {"samples"}, "number of samples of the pixel"},
    };
    return all;
}

inline std::vector<std::string> AovNames() {
    std::vector<std::string> names;
    for (const Aov &aov : Aovs()) names.emplace_back(aov.name);
    return names;
}

/// Film with additional channels: means over a pixel's samples of visible-surface data, in camera space, and the number
/// of samples. All else is the wrapped film's, bit for bit. Existing channels are not added.
class AovFilm final : public Film {
  public:
    /// `context.overrides.aovs` names the quantities. Throws UserError if the file format cannot hold them.
    AovFilm(std::unique_ptr<Film> film, const FilmContext &context)
        : Film(KindWith(film->kind_, context.overrides.aovs), film->frame_), film_(std::move(film)),
          renderFromCamera_(context.renderFromCamera), chosen_(IndicesOf(context.overrides.aovs)),
          stride_(kFirstChannel + ChannelCount(chosen_)) {
        if (LowerExtension(Filename()) != ".exr")
            throw UserError("--aov: \"{}\": the added channels only fit into an .exr file.", Filename());
        const Bounds2i &bounds = PixelBounds();
        RequireMemory(
            double(Frame().PixelCount()) * double(stride_ * sizeof(PreciseSum) + ChannelCount(chosen_) * sizeof(float)),
            fmt::format("--aov: an image of {} x {} pixels", bounds.Width(), bounds.Height()), {});
        sums_.resize(Frame().PixelCount() * stride_);
    }

    SampledWavelengths SampleWavelengths(Float u) const override { return film_->SampleWavelengths(u); }
    bool NeedsVisibleSurface() const override { return true; }
    void AddSample(const FilmSample &sample) override {
        film_->AddSample(sample);
        const auto w = double(sample.weight);
        if (!std::isfinite(w)) return;
        PreciseSum *sums = sums_.data() + Frame().IndexOf(sample.pixel) * stride_;
        if (chosen_.back() == kSamples) sums[stride_ - 1].Add(1);
        if (sample.hasRay) sums[0].Add(w);
        if (!sample.visible) return;
        sums[1].Add(w);
        const VisibleSurface &visible = *sample.visible;
        const Transform cameraFromRender = renderFromCamera_.At(visible.time).Inverse();
        PreciseSum *next = sums + kFirstChannel;
        const auto add = [&](const auto &v) {
            for (int c = 0; c < v.length(); ++c) (next++)->Add(w * double(v[c]));
        };
        for (const size_t i : chosen_) {
            if (i == kAlbedo) add(AlbedoColor(visible, OutputSpace()));
            if (i == kNormal) add(Normalize(cameraFromRender.Normal(visible.ns)));
            if (i == kGeonormal) add(Normalize(cameraFromRender.Normal(visible.n)));
            if (i == kPosition) add(cameraFromRender.Point(visible.p));
            if (i == kDepth) (next++)->Add(w * double(cameraFromRender.Point(visible.p).z));
            if (i == kUv) add(visible.uv);
        }
    }
    void ExpectSplats() override { film_->ExpectSplats(); }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override {
        film_->AddSplat(pixel, L, lambda, weight);
    }
    void AddSplatPaths(uint64_t paths) override { film_->AddSplatPaths(paths); }
    Image ToImage() const override {
        const Image colors = film_->ToImage();
        std::vector<std::string> channels = colors.Channels();
        for (const size_t i : chosen_)
            for (const char *name : Aovs()[i].channels)
                if (colors.FindChannel(name) < 0) channels.emplace_back(name);
        Image image(colors.Format(), colors.Resolution(), channels, colors.Encoding());
        const PreciseSum *sums = sums_.data();
        ForEachPixel(image, [&](Point2i p) {
            for (int c = 0; c < colors.ChannelCount(); ++c) image.Set(p, c, colors.Get(p, c));
            const double all = sums[0].Value(), seen = sums[1].Value();
            int channel = colors.ChannelCount();
            const PreciseSum *next = sums + kFirstChannel;
            for (const size_t i : chosen_) {
                const std::vector<const char *> &names = Aovs()[i].channels;
                glm::dvec3 mean(0);
                // Albedo counts rays without a hit as black; geometry excludes them.
                const double weight = i == kSamples ? 1 : i == kAlbedo ? all : seen;
                for (size_t c = 0; c < names.size(); ++c, ++next)
                    mean[int(c)] = weight != 0 ? next->Value() / weight : 0;
                if (i == kNormal || i == kGeonormal) mean = UnitOrZero(mean);
                if (colors.FindChannel(names[0]) >= 0) continue;
                for (size_t c = 0; c < names.size(); ++c) image.Set(p, channel++, Float(mean[int(c)]));
            }
            sums += stride_;
        });
        return image;
    }
    Image Colors() const override { return film_->Colors(); }
    ImageMetadata Metadata() const override { return film_->Metadata(); }
    uint64_t RejectedSamples() const override { return film_->RejectedSamples(); }
    std::unique_ptr<Film> MakeRgbFilm() const override { return film_->MakeRgbFilm(); }

  private:
    enum : size_t { kAlbedo, kNormal, kGeonormal, kPosition, kDepth, kUv, kSamples };
    static constexpr size_t kFirstChannel = 2;  ///< in a pixel's sums
    static std::vector<size_t> IndicesOf(const std::vector<std::string> &names) {
        const std::vector<std::string> known = AovNames();
        std::set<size_t> indices;
        for (const std::string &name : names) {
            const auto found = std::find(known.begin(), known.end(), name);
            if (found == known.end()) throw UserError("--aov: \"{}\" is unknown; {}", name, ListChoices(name, known));
            indices.insert(found - known.begin());
        }
        return {indices.begin(), indices.end()};
    }
    /// Kind of the saved states, which includes the channels so that other sets do not match.
    static std::string KindWith(const std::string &kind, const std::vector<std::string> &names) {
        unsigned bits = 0;
        for (const size_t i : IndicesOf(names)) bits |= 1u << i;
        return fmt::format("{} aov {:x}", kind, bits);
    }
    static size_t ChannelCount(const std::vector<size_t> &aovs) {
        size_t count = 0;
        for (const size_t i : aovs) count += Aovs()[i].channels.size();
        return count;
    }
    std::vector<StateBlock> Blocks() const override {
        std::vector<StateBlock> blocks = film_->Blocks();
        blocks.push_back(MakeStateBlock("aov", std::span(sums_)));
        return blocks;
    }
    std::unique_ptr<Film> film_;
    AnimatedTransform renderFromCamera_;
    std::vector<size_t> chosen_;  ///< indices into Aovs(), ascending
    size_t stride_ = 0;           ///< per pixel: weights of samples with a ray, of those that hit a surface, channels
    std::vector<PreciseSum> sums_;
};

}  // namespace pbrt
