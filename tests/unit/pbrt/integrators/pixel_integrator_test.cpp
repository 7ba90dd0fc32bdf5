// Tests what pixel integrators do in a pass, and what they report of the first surface.
#include "pbrt/integrators/pixel_integrator.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>

#include "pbrt/core/counters.h"
#include "pbrt/integrators/render_loop.h"
#include "support/build_text.h"
#include "support/light_views.h"

namespace pbrt::test {
namespace {

/// A textured floor behind a surface that does not scatter, seen from above.
std::string TexturedScene(const std::string &film, const std::string &integrator, int maxDepth) {
    SceneText text;
    text.Head("Option 'rendercoordsys' 'world'").LookAt("0 0 4  0.3 0.1 0  0 1 0").Camera(40);
    text.Film(24, 20, "'bool savefp16' false", film).Samples(2);
    if (integrator == "ambientocclusion") text.Integrator(integrator);
    else text.Integrator(integrator, maxDepth);
    return text.World(Objects()
                          .Light("infinite")
                          .Add("Texture 't' 'spectrum' 'checkerboard' 'float uscale' 3 'float vscale' 3 "
                               "'rgb tex1' [.2 .4 .6] 'rgb tex2' [.8 .3 .1]")
                          .Attribute("Material 'interface'", Objects().Sphere(1))
                          .Material("diffuse", "'texture reflectance' 't'")
                          .Quad("-1 -1 -.5  1 -1 -.7  -1 1 -.5  1 1 -.5"));
}

struct Seen {
    Image image;
    uint64_t rays;
};

Seen Render(const std::string &film, const std::string &integrator, int maxDepth = 3) {
    ResetCounters();
    return {RenderText(TexturedScene(film, integrator, maxDepth)).image, SumCounters().closestHitRays};
}

const std::vector<std::string> kIntegrators = {"path", "volpath", "simplepath", "randomwalk", "ambientocclusion"};

/// Green of the albedo of a grey wall through a lens, over the pixels that see it.
double AlbedoBehindLens(const std::string &film, int aperture) {
    BuildOptions options;
    if (film == "rgb") options.film.aovs = {"albedo"};
    const Image image =
        RenderText(
            SceneText()
                .LookAt("0 0 4  0 0 0  0 1 0")
                .Head(fmt::format("{} 'float aperturediameter' {}", kRealisticCamera, aperture))
                .Film(16, 16, "", film)
                .Samples(64)
                .World(Objects().Light("infinite").Material("diffuse").Quad("-90 -90 0  90 -90 0  -90 90 0  90 90 0")),
            options)
            .image;
    double sum = 0;
    int count = 0;
    ForEachPixel(image, [&](Point2i p) {
        const Float albedo = image.Get(p, image.FindChannel("Albedo.G"));
        sum += double(albedo);
        count += albedo > 0;
    });
    EXPECT_GT(count, 200);
    return sum / count;
}

TEST(VisibleSurface, SamplesThatTheLensStopsAreNotBlack) {
    for (const char *film : {"gbuffer", "rgb"})
        for (const int aperture : {1, 4, 8}) EXPECT_NEAR(AlbedoBehindLens(film, aperture), .5, .01) << aperture;
}

TEST(VisibleSurface, IsTheSameForEveryIntegrator) {
    const Image expected = Render("gbuffer", "path").image;
    for (const std::string &integrator : kIntegrators)
        for (int maxDepth : {0, 3}) {
            const Image image = Render("gbuffer", integrator, maxDepth).image;
            int seen = 0;
            ForEachValue(image, [&](Point2i p, int c) {
                const std::string &channel = image.Channels()[c];
                if (c < 3 || channel.find("Variance") != std::string::npos) return;
                ASSERT_EQ(image.Get(p, c), expected.Get(p, c)) << integrator << " " << maxDepth << " " << channel;
                seen += image.Get(p, c) != 0;
            });
            EXPECT_GT(seen, 2000) << integrator;
        }
}

TEST(VisibleSurface, TracesNoRaysAndKeepsTheRadiance) {
    for (const std::string &integrator : kIntegrators) {
        const Seen a = Render("gbuffer", integrator), b = Render("rgb", integrator);
        EXPECT_EQ(a.rays, b.rays) << integrator;
        ForEachValue(b.image, [&](Point2i p, int c) { ASSERT_EQ(a.image.Get(p, c), b.image.Get(p, c)) << integrator; });
    }
}

/// Records the samples whose radiance is evaluated.
class Census final : public PixelIntegrator {
  public:
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &, Sampler &sampler) const override {
        const std::lock_guard lock(mutex);
        ++calls;
        asksForSurface |= start.visible != nullptr;
        times.insert(start.ray.ray.time);
        samples.insert({start.pixel.x, start.pixel.y, start.sampleIndex});
        return SampledSpectrum(1 + sampler.Get1D());
    }
    mutable std::mutex mutex;
    mutable int calls = 0;
    mutable bool asksForSurface = false;
    mutable std::set<Float> times;
    mutable std::set<std::tuple<int, int, int>> samples;
};

class PixelPass : public ::testing::Test {
  protected:
    bool Render(const std::string &film, int first, int count, bool jitters = true, bool keepsSamples = true) {
        if (!built_.film || film != kind_) built_ = BuildText(TexturedScene(film, "path", 1));
        kind_ = film;
        std::vector<std::unique_ptr<Sampler>> samplers;
        for (int i = 0; i < ThreadCount(); ++i) samplers.push_back(built_.sampler->Clone());
        return census_.Render({.camera = *built_.camera,
                               .filter = *built_.filter,
                               .film = *built_.film,
                               .samplers = samplers,
                               .samplesPerPixel = 8,
                               .first = first,
                               .count = count,
                               .jittersPixels = jitters,
                               .keepsSamples = keepsSamples,
                               .progress = progress_});
    }
    std::string State() const {
        StateWriter out;
        built_.film->Save(out);
        return out.Joined();
    }
    BuiltScene built_;
    std::string kind_;
    Census census_;
    Progress progress_;
};

TEST_F(PixelPass, ThreadsAndSplitsMakeNoDifference) {
    std::string expected;
    for (int threads : {1, 2, 7}) {
        const ThreadLimit limit(threads);
        built_ = {};
        EXPECT_TRUE(Render("rgb", 0, 8));
        if (expected.empty()) expected = State();
        EXPECT_EQ(State(), expected);
    }
    built_ = {};
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(Render("rgb", i, 1));
    EXPECT_EQ(State(), expected);
    EXPECT_EQ(census_.calls, 4 * 8 * 24 * 20);
    EXPECT_EQ(census_.samples.size(), 8u * 24 * 20);
}

TEST_F(PixelPass, TheSurfaceIsRecordedForFilmsThatNeedIt) {
    Render("rgb", 0, 1);
    Render("spectral", 0, 1);
    EXPECT_FALSE(census_.asksForSurface);
    Render("gbuffer", 0, 1);
    EXPECT_TRUE(census_.asksForSurface);
}

TEST_F(PixelPass, WithoutJitterAllRaysHaveOneTime) {
    Render("rgb", 0, 2, false);
    EXPECT_EQ(census_.times.size(), 1u);
    Render("rgb", 0, 2, true);
    EXPECT_GT(census_.times.size(), 100u);
}

TEST_F(PixelPass, SamplesThatTheFilmHasAreTracedButNotAdded) {
    Render("rgb", 0, 1);
    const std::string before = State();
    const int calls = census_.calls;
    EXPECT_TRUE(Render("rgb", 1, 1, true, false));
    EXPECT_EQ(census_.calls, 2 * calls);
    EXPECT_EQ(State(), before);
}

TEST_F(PixelPass, ACancelledPassReturnsFalse) {
    progress_.Cancel();
    EXPECT_FALSE(Render("rgb", 0, 1));
    EXPECT_EQ(census_.calls, 0);
}

}  // namespace
}  // namespace pbrt::test
