// The octree sampler keeps learning while it renders: same picture however the work is divided, valid
// probabilities.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>

#include "pbrt/core/online_model.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/metrics.h"
#include "support/light_query.h"
#include "support/render_waves.h"
#include "support/temporary_image.h"
#include "two_rooms.h"

namespace pbrt::test {
namespace {

constexpr int kSamples = 16;  ///< learned from after 1 and 4

/// A view from `eyeTargetUp` in world space.
BuiltScene BuildView(const std::string &eyeTargetUp, double fov, const std::string &parameters, const Objects &world) {
    return BuildText(SceneText()
                         .InWorldSpace()
                         .LookAt(eyeTargetUp)
                         .Camera(fov)
                         .Film(40, 40, "'bool savefp16' false")
                         .Samples(kSamples)
                         .Integrator("path", 2, parameters)
                         .World(world));
}

/// Of two rooms the camera looks down on the left one.
BuiltScene Build(const std::string &parameters = "") {
    return BuildView("-2 6 0  -2 0 0  0 0 1", 40, "'string lightsampler' 'octree' " + parameters, TwoRooms());
}

Objects OpenField() { return Objects().Sky("1 2 3").Material("diffuse").Quad(room::kFloor); }
/// A closed room with a window, and a sky of one colour or this light outside.
Objects RoomWithWindow(const Objects &outside = Objects().Sky("1 2 3")) {
    return Objects()
        .Add(outside)
        .Material("diffuse")
        .Quad(room::kFloor)
        .Quad(room::kCeiling)
        .Quad(room::kFront)
        .Quad(room::kBack)
        .Quad(room::kRight)
        .Quad("-3 0 -3  -3 0 0  -3 2 -3  -3 2 0")
        .Quad("-3 0 1  -3 0 3  -3 2 1  -3 2 3")
        .Quad("-3 0 0  -3 0 1  -3 1 0  -3 1 1");
}
BuiltScene BuildUnderSky(const std::string &parameters, const Objects &world) {
    return BuildView("0 1 -2.9  0 1 0  0 1 0", 70, parameters, world);
}
BuiltScene BuildRoom(const std::string &parameters = "") {
    return BuildUnderSky("'string lightsampler' 'octree' 'integer octree.prepassspp' 1 " +
                             (parameters.empty() ? "'string octree.portals' 'always'" : parameters),
                         RoomWithWindow());
}

/// Renders in calls of these sizes, the last one again and again.
Image Render(const BuiltScene &built, const std::vector<int> &sizes = {kSamples}) {
    return RenderWaves(built, kSamples, sizes);
}

/// Makes a scene with these parameters of the sampler.
using Maker = std::function<BuiltScene(const std::string &)>;

Image RenderWith(const Maker &make, int threads, std::vector<int> sizes, const std::string &parameters = "") {
    ThreadLimit limit(threads);
    BuiltScene built = make(parameters);
    return Render(built, std::move(sizes));
}

/// Any number of threads and any split give the same picture. `others`: parameters that give another one.
void CheckThreadsAndSplits(const Maker &make, const std::vector<std::string> &others) {
    const Image whole = RenderWith(make, 1, {kSamples});
    EXPECT_TRUE(SameBits(whole, RenderWith(make, 3, {kSamples})));
    EXPECT_TRUE(SameBits(whole, RenderWith(make, 2, {1})));
    EXPECT_TRUE(SameBits(whole, RenderWith(make, 1, {3, 2, 7, 1})));
    for (const std::string &parameters : others)
        EXPECT_FALSE(SameBits(whole, RenderWith(make, 1, {kSamples}, parameters))) << parameters << " changed nothing";
}

TEST(LearningWhileRendering, AnyThreadsAndAnySplitGiveTheSamePicture) {
    CheckThreadsAndSplits(Build, {"'bool octree.learn' false"});
}

TEST(LearningWhileRendering, AnyThreadsAndAnySplitGiveTheSamePictureThroughAPortal) {
    CheckThreadsAndSplits(BuildRoom, {"'string octree.portals' 'never'"});
    // Prepared again, it finds the same.
    BuiltScene built = BuildRoom();
    const Image first = Render(built);
    EXPECT_TRUE(SameBits(first, Render(built)));
}

/// Unless portals are requested for a room, the environment is sampled as one light: the image is that of bvh.
TEST(PortalsOfAnOpenScene, AreNotUsedAndTheImageIsThatOfBvh) {
    const std::string always = "'string octree.portals' 'always'";
    for (const auto &[world, parameters, least, most, isOneLight] :
         {std::tuple{OpenField(), std::string(), 1.0, 1.0, true},
          {OpenField(), always, 1.0, 1.0, true},
          {RoomWithWindow(), "", 0.005, 0.3, true},
          {RoomWithWindow(), always, 0.005, 0.3, false}}) {
        BuiltScene octree =
                       BuildUnderSky("'string lightsampler' 'octree' 'bool guide.roulette' false " + parameters, world),
                   bvh = BuildUnderSky("'string lightsampler' 'bvh'", world);
        EXPECT_EQ(SameBits(Render(octree), Render(bvh)), isOneLight);
        nlohmann::ordered_json report;
        octree.integrator->Lights()->Report(report);
        EXPECT_EQ(report.contains("portals"), !isOneLight);
        // These renders are too short for a trial, without which nothing is searched.
        EXPECT_EQ(report.contains("environmentSeenShare"), !parameters.empty());
        const double seen = report.value("environmentSeenShare", least);
        EXPECT_GE(seen, least);
        EXPECT_LE(seen, most);
    }
}

/// A closed room with this many lamps; before the first shadow ray, the sun outside is the light to choose.
BuiltScene BuildRoomInTheSun(const std::string &sampler, const std::string &sun, int lamps) {
    Objects world =
        Objects().Light("distant", "'point3 from' [ 1 2 1 ] 'rgb L' [ " + sun + " ]").Diffuse("0.7 0.6 0.5");
    for (const auto &wall : {room::kFloor, room::kCeiling, room::kFront, room::kBack, room::kLeft, room::kRight})
        world.Quad(wall);
    for (int i = 0; i < lamps; ++i) {
        const double across = (i % 10 + 0.5) / 10, along = (i / 10 + 0.5) / 10;
        world.PointLight(lamps == 1 ? "0 1.8 1" : fmt::format("{} 1.8 {}", 1.6 * across - 0.8, 1.6 * along),
                         lamps == 1 ? "1 1 1" : "0.01 0.01 0.01");
    }
    return BuildUnderSky("'bool guide.roulette' false 'string lightsampler' '" + sampler + "'", world);
}

TEST(StrongLightBehindAWall, AddsNoNoise) {
    for (const int lamps : {1, 100}) {  // the octree sampler tests all lights of the one, some of the other
        const Image reference = RenderWaves(BuildRoomInTheSun("uniform", "1 1 1", lamps), 512, {512});
        const auto error = [&](const std::string &sun) {
            return ImageError(Render(BuildRoomInTheSun("octree", sun, lamps)), reference, Metric::RelL2);
        };
        const double weak = error("0.001 0.001 0.001");
        for (const char *sun : {"1e2 1e2 1e2", "1e4 1e4 1e4", "1e6 1e6 1e6"})
            EXPECT_LT(error(sun), 1.5 * weak) << sun << ", lamps: " << lamps;
    }
}

/// Report of the octree sampler, prepared for this many samples per pixel.
nlohmann::ordered_json ReportOf(const Objects &world, int samples, int threads) {
    ThreadLimit limit(threads);
    BuiltScene built = BuildUnderSky("'string lightsampler' 'octree'", world);
    Progress progress;
    PrepareFor(samples, built, progress);
    nlohmann::ordered_json report;
    built.integrator->Lights()->Report(report);
    return report;
}

TEST(PortalsOnTrial, AreUsedWhereTheyPay) {
    const nlohmann::ordered_json dark = ReportOf(RoomWithWindow(), 128, 1);
    EXPECT_GT(dark["portalTrial"]["gain"].get<double>(), 1);
    EXPECT_EQ(dark.value("portals", 0), 1);
    EXPECT_EQ(dark["portalTrial"], ReportOf(RoomWithWindow(), 128, 3)["portalTrial"]);
    // The noise is the lamp's.
    const Objects lit =
        RoomWithWindow().Attribute("", Objects().AreaLight("500 500 500").Quad("0 1.9 0  1 1.9 0  0 1.9 1  1 1.9 1"));
    const nlohmann::ordered_json bright = ReportOf(lit, 128, 2);
    EXPECT_LT(bright["portalTrial"]["gain"].get<double>(), 1);
    EXPECT_GT(bright["portalTrial"]["relativeCost"].get<double>(), 1);
    EXPECT_FALSE(bright.contains("portals"));
    // Too short for a trial.
    const nlohmann::ordered_json brief = ReportOf(RoomWithWindow(), 16, 2);
    EXPECT_FALSE(brief.contains("portalTrial"));
    EXPECT_FALSE(brief.contains("portals"));
}

/// Nearly all light outside is that of a sun on the other side of the room; the sky lights it.
TEST(PortalsOnTrial, AreFoundBesideASunThatDoesNotEnter) {
    const TemporaryImage sky(
        "sun.exr", RgbImage({32, 32}, [](int x, int y) { return x == 31 && y == 16 ? Rgb(1e5f) : Rgb(1.f); }));
    const nlohmann::ordered_json report =
        ReportOf(RoomWithWindow(Objects().Light("infinite", "'string filename' '" + sky.Path() + "'")), 128, 1);
    EXPECT_EQ(report.value("portals", 0), 1);
}

/// Taking a run up again gives the same picture.
void CheckTakingUp(const Maker &make) {
    BuiltScene uninterrupted = make("");
    const Image whole = Render(uninterrupted);
    for (int stop : {1, 3, 4, 6}) {
        PartRender first(make(""), kSamples), second(make(""), kSamples);
        first.RenderUntil(stop);
        second.LoadFilm(first.SavedFilm());
        second.renderer->ContinueFrom(stop);
        second.RenderUntil(kSamples);
        EXPECT_TRUE(SameBits(whole, second.built.film->ToImage())) << "stopped after " << stop;
    }
}

TEST(LearningWhileRendering, AResumedRunLearnsTheSame) { CheckTakingUp(Build); }
TEST(LearningWhileRendering, AResumedRunDetectsTheSamePortal) { CheckTakingUp(BuildRoom); }

/// A render that stopped somewhere: film, position, and what was learned.
struct Stopped {
    std::string film, learned;
    RenderPosition position;
};

Stopped StateOf(const PartRender &part, const WaveRenderer &renderer) {
    StateWriter learned;
    part.built.integrator->Lights()->SaveLearned(learned, true);
    return {part.SavedFilm(), learned.Joined(), renderer.Position()};
}

/// Renders what is left.
Image GoOn(const Maker &make, const Stopped &from) {
    StateReader reader(from.learned, "state");
    PartRender part(make(""), kSamples, &reader);
    EXPECT_EQ(reader.BytesLeft(), 0u);
    // What was loaded is saved again bit by bit.
    EXPECT_EQ(StateOf(part, *part.renderer).learned, from.learned);
    part.LoadFilm(from.film);
    part.renderer->GoOnFrom(from.position);
    part.RenderUntil(kSamples);
    return part.built.film->ToImage();
}

/// A filter that cancels the render at its n-th evaluation. The renders here evaluate it once a sample of a
/// pixel: 25,600 times, with waves that end at 1,600 and 6,400.
class CancellingFilter : public Filter {
  public:
    CancellingFilter(const Filter &filter, int draws, Progress &progress)
        : Filter(filter.Radius()), filter_(filter), left_(draws), progress_(progress) {}
    Float Evaluate(const Point2 &p) const override { return filter_.Evaluate(p); }
    Float Integral() const override { return filter_.Integral(); }
    Float Pdf(const Point2 &p) const override { return filter_.Pdf(p); }
    FilterSample Sample(const Point2 &u) const override {
        if (left_.fetch_sub(1) == 1) progress_.Cancel();
        return filter_.Sample(u);
    }

  private:
    const Filter &filter_;
    mutable std::atomic<int> left_;
    Progress &progress_;
};

/// What was learned can be saved between any two waves, also before and after learning, and in the middle of a wave
/// that was cancelled: the render resumed from there gives the same picture.
void CheckSavedState(const Maker &make) {
    BuiltScene uninterrupted = make("");
    const Image whole = Render(uninterrupted);
    for (int stop : {0, 1, 3, 4, 6, 15}) {
        PartRender part(make(""), kSamples);
        part.RenderUntil(stop);
        EXPECT_TRUE(SameBits(whole, GoOn(make, StateOf(part, *part.renderer)))) << "stopped after " << stop;
    }
    int amidWave = 0;
    for (int draws : {1, 100, 1000, 2500, 5000, 8000, 16000, 24000}) {
        PartRender part(make(""), kSamples);
        const BuiltScene &built = part.built;
        const CancellingFilter filter(*built.filter, draws, part.progress);
        WaveRenderer renderer({*built.integrator, *built.camera, filter, *built.film, *built.sampler, part.progress},
                              part.settings);
        while (renderer.Done() < kSamples && renderer.Render(kSamples) > 0) {
        }
        amidWave += renderer.Position().passCount > 0;
        EXPECT_TRUE(SameBits(whole, GoOn(make, StateOf(part, renderer)))) << draws;
    }
    EXPECT_EQ(amidWave, 8) << "not tested: a wave that was to be cancelled was finished";
    // The state matters: without what the last sample found the picture is another one.
    if (!make("").integrator->Model()) return;
    int compared = 0;
    for (int stop : {2, 3, 5, 6, 7}) {
        PartRender part(make(""), kSamples);
        part.RenderUntil(stop - 1);
        const std::string before = StateOf(part, *part.renderer).learned;
        const int next = part.built.integrator->Model()->NextUpdate();
        part.RenderUntil(stop);
        Stopped wrong = StateOf(part, *part.renderer);
        if (next <= stop || wrong.learned == before) continue;
        wrong.learned = before;
        EXPECT_FALSE(SameBits(whole, GoOn(make, wrong))) << stop;
        ++compared;
    }
    EXPECT_GT(compared, 0);
}

TEST(LearningWhileRendering, ASavedStateContinuesBitByBit) { CheckSavedState(Build); }
TEST(LearningWhileRendering, ASavedStateContinuesBitByBitThroughAPortal) { CheckSavedState(BuildRoom); }
TEST(LearningWhileRendering, ASavedStateContinuesBitByBitWithThePapersModel) {
    CheckSavedState([](const std::string &parameters) { return Build("'string octree.model' 'paper' " + parameters); });
}

TEST(LearningWhileRendering, DamagedStatesThrow) {
    for (const Maker &make : {Maker(Build), Maker(BuildRoom)}) {
        BuiltScene built = make("");
        Progress progress;
        PrepareFor(kSamples, built, progress);
        StateWriter writer;
        built.integrator->Lights()->SaveLearned(writer, true);
        const std::string whole = writer.Joined();
        const auto expectThrow = [&](const std::string &state) {
            BuiltScene other = make("");
            StateReader reader(state, "state");
            PrepareContext context = other.Preparation(progress);
            context.learned = &reader;
            EXPECT_THROW(other.integrator->Prepare(context), UserError);
        };
        for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50) expectThrow(whole.substr(0, size));
        expectThrow(std::string(whole.size(), '\x7f'));
        std::string version = whole;
        ++version[0];
        expectThrow(version);
    }
}

/// Points on the floor of the left room.
std::vector<LightQuery> Floor() {
    std::vector<LightQuery> queries;
    for (int i = 0; i < 100; ++i)
        queries.push_back(QueryAt({-3.8f + 0.4f * Float(i % 10), 0, -1.9f + 0.4f * Float(i / 10)}, {0, 1, 0}));
    return queries;
}

TEST(LearningWhileRendering, LightsBehindTheWallAreHardlyChosen) {
    auto hidden = [](const LightSampler &lights) {
        Float sum = 0;
        for (const LightQuery &q : Floor())
            for (uint32_t l = kLampsPerRoom; l < 2 * kLampsPerRoom; ++l) sum += lights.PMF(q, LightId(l));
        return sum / 100;
    };
    // A prepass with too few shadow rays to separate the rooms.
    BuiltScene built = Build("'float octree.budget' 0.0001");
    Progress progress;
    PrepareFor(kSamples, built, progress);
    const Float before = hidden(*built.integrator->Lights());
    Render(built);
    const Float after = hidden(*built.integrator->Lights());
    EXPECT_GT(before, 0.1f);
    EXPECT_LT(after, before / 10);
}

TEST(LearningWhileRendering, CancelledLearningLeavesEverythingAsItWas) {
    auto probabilities = [](const BuiltScene &built) {
        std::vector<Float> all;
        for (const LightQuery &q : Floor())
            for (uint32_t l = 0; l < 2 * kLampsPerRoom; ++l)
                all.push_back(built.integrator->Lights()->PMF(q, LightId(l)));
        return all;
    };
    auto takeOneSample = [](BuiltScene &built, Progress &progress, int wanted) {
        RenderSettings settings;
        settings.samplesPerPixel = kSamples;
        PrepareFor(kSamples, built, progress);
        WaveRenderer renderer(built.Rendering(progress), settings);
        EXPECT_EQ(renderer.Render(1), 1);
        progress.Cancel();
        EXPECT_EQ(renderer.Render(1), wanted);
        return renderer.Done();
    };
    BuiltScene stopped = Build();
    Progress cancelled;
    EXPECT_EQ(takeOneSample(stopped, cancelled, 0), 1);
    OnlineModel &learner = *stopped.integrator->Model();
    EXPECT_EQ(learner.NextUpdate(), 1) << "it reports that it has learned";
    BuiltScene prepared = Build();
    Progress never;
    PrepareFor(kSamples, prepared, never);
    const std::vector<Float> before = probabilities(prepared);
    EXPECT_EQ(probabilities(stopped), before);
    for (int again = 0; again < 2; ++again) learner.Update(cancelled);
    EXPECT_EQ(probabilities(stopped), before);
    EXPECT_EQ(learner.NextUpdate(), 1);

    // What the sample found is still there, and once only: later it learns what it would have learned then.
    learner.Update(never);
    EXPECT_EQ(learner.NextUpdate(), 4);
    BuiltScene whole = Build();
    Progress other;
    takeOneSample(whole, other, 0);
    whole.integrator->Model()->Update(never);
    EXPECT_EQ(probabilities(stopped), probabilities(whole));
    EXPECT_NE(probabilities(stopped), before) << "nothing was learned";
}

TEST(LearningWhileRendering, ProbabilitiesAreValidAfterwards) {
    BuiltScene built = Build();
    Render(built);
    const LightSampler &lights = *built.integrator->Lights();
    for (const LightQuery &q : Floor()) {
        double sum = 0;
        for (uint32_t l = 0; l < 2 * kLampsPerRoom; ++l) {
            const Float pmf = lights.PMF(q, LightId(l));
            EXPECT_GT(pmf, 0);
            sum += double(pmf);
        }
        EXPECT_NEAR(sum, 1, 1e-5);
        // Weights stand for all unoccluded light together, estimated by nodes of the light tree.
        double weights = 0;
        for (int i = 0; i < 500; ++i) {
            const std::optional<SampledLight> light = lights.Sample(q, (Float(i) + 0.5f) / 500);
            ASSERT_TRUE(light);
            EXPECT_GT(light->unoccluded, 0);
            weights += double(light->weight) / 500;
        }
        EXPECT_NEAR(weights, 1, 0.3);
        for (Float u : {0.f, 0.01f, 0.3f, 0.77f, OneMinusEpsilon}) {
            const std::optional<SampledLight> light = lights.Sample(q, u);
            ASSERT_TRUE(light);
            EXPECT_EQ(light->pmf, lights.PMF(q, light->light));
        }
    }
}

}  // namespace
}  // namespace pbrt::test
