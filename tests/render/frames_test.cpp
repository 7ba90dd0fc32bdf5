// Frames of an animation that share what was learned: the noise of a place does not change from frame to frame.
#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/state_io.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/transport/vertex.h"
#include "support/build_text.h"
#include "support/light_query.h"
#include "support/statistics.h"
#include "two_rooms.h"

namespace pbrt::test {
namespace {

constexpr int kFrameSamples = 8, kFrames = 4;

/// The camera looks down on the floor of the left one and moves to the
/// right by half a metre a frame.
BuiltScene Frame(int frame) {
    const double x = -2.6 + 0.5 * frame;
    return BuildText(SceneText()
                         .InWorldSpace()
                         .LookAt(fmt::format("{0} 6 0  {0} 0 0  0 0 1", x))
                         .Camera(30)
                         .Film(32, 32, "'bool savefp16' false")
                         .Samples(kFrameSamples)
                         .Integrator("path", 1, "'string lightsampler' 'octree' 'float octree.budget' 0.02")
                         .World(TwoRooms().Quad("-2.4 0 -1  -1.2 0 -1  -2.4 .8 -.6  -1.2 .8 -.6")));
}

/// Renders a frame to its end, so that its light sampler learns all that it learns from the frame, or uses what was
/// `learned`.
BuiltScene RenderFrame(int frame, StateReader *learned = nullptr) {
    BuiltScene built = Frame(frame);
    Progress progress;
    PrepareContext context = built.Preparation(progress);
    context.samplesPerPixel = kFrameSamples;
    context.learned = learned;
    context.learnsOn = learned == nullptr;
    built.integrator->Prepare(context);
    RenderSettings settings;
    settings.samplesPerPixel = kFrameSamples;
    RenderWaves(built.Rendering(progress), settings);
    return built;
}

/// The relative variance of one light sample at a place of the floor that all frames see: of f / p for lights chosen
/// with probability p, whose unoccluded or hidden contributions f are added up exactly. Slow, but simple.
double NoiseAt(const BuiltScene &built, const Point3 &p) {
    const LightQuery query = QueryAt(p, {0, 1, 0});
    const LightSampleContext from{.p = p, .n = query.n, .ns = query.n};
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < 2 * kLampsPerRoom; ++i) {
        const auto s = built.scene->Lights()[LightId(i)].SampleLi(from, {}, lambda, false);
        if (!s || built.scene->Occluded(from, *s)) continue;
        const double f = double(s->L.Average() * AbsDot(s->wi, query.n));
        sum += f;
        squares += f * f / double(built.integrator->Lights()->PMF(query, LightId(i)));
    }
    return squares / (sum * sum) - 1;
}

constexpr int kPlaces = 100;
/// On the floor, where all frames see it.
Point3 PlaceOf(int i) { return Point3(-2.2f + 0.1f * Float(i % 10), 1e-3f, -1.2f + 0.24f * Float(i / 10)); }

/// How much the noise of places differs between frames: the standard deviation of its logarithm, averaged.
double Flicker(const std::vector<BuiltScene> &frames) {
    double sum = 0;
    for (int i = 0; i < kPlaces; ++i) {
        RunningStatistics noise;
        for (const BuiltScene &frame : frames) noise.Add(std::log(NoiseAt(frame, PlaceOf(i))));
        sum += std::sqrt(noise.Variance());
    }
    return sum / kPlaces;
}

TEST(FramesOfAnAnimation, ShareTheirNoiseIfTheyShareWhatWasLearned) {
    BuiltScene training = RenderFrame(0);
    StateWriter writer;
    training.integrator->Lights()->SaveLearned(writer, false);
    const std::string learned = writer.Joined();
    std::vector<BuiltScene> shared, alone;
    for (int i = 0; i < kFrames; ++i) {
        StateReader reader(learned, "learned lights");
        shared.push_back(RenderFrame(i, &reader));
        alone.push_back(RenderFrame(i));
    }
    EXPECT_EQ(Flicker(shared), 0);
    // Frames that learn for themselves, each from its own view, are what would flicker.
    EXPECT_GT(Flicker(alone), 0.02);
    // What was learned from the first frame serves the others as well as what they would have learned.
    for (int i = 0; i < kFrames; ++i) {
        double ours = 0, own = 0;
        for (int k = 0; k < kPlaces; ++k) {
            ours += NoiseAt(shared[size_t(i)], PlaceOf(k));
            own += NoiseAt(alone[size_t(i)], PlaceOf(k));
        }
        EXPECT_LT(ours, 1.3 * own) << "frame " << i;
    }
}

}  // namespace
}  // namespace pbrt::test
