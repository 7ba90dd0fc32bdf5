#include "ext/lab/inspect.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pbrt/core/files.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/render_scene.h"
#include "support/scene_text.h"
#include "support/threads.h"
#include "support/wrapped_sampler.h"

namespace ext::lab {
namespace {

using test::Objects, test::SceneText;

/// An orthographic view of 4 x 4 units, straight down on a floor of 2 x 2. Lights 0 and 1 are a mesh that faces away
/// from everything. Light 2 is a point above the middle, seen from everywhere. Light 3 is a point far to the left,
/// hidden from the right half by a wall in the middle.
std::string InspectedScene() {
    return SceneText()
        .InWorldSpace()
        .LookAt("0 0 10  0 0 0  0 1 0")
        .Camera("orthographic", "'float screenwindow' [ -2 2 -2 2 ]")
        .Film(32, 32)
        .Samples(4)
        .Integrator("path", "'string lightsampler' 'uniform'")
        .World(Objects()
                   .PointLight("0 0 1.5", "1 1 1")
                   .PointLight("-4 0 0.5", "400 400 400")
                   .Attribute("", Objects().AreaLight("1 1 1").Triangles("-1 -1 30  1 -1 30  1 1 30  -1 1 30"))
                   .Diffuse(".5 .5 .5")
                   .Quad("-1 -1 0  1 -1 0  -1 1 0  1 1 0")
                   .Quad("0 -9 0  0 9 0  0 -9 1  0 9 1"));
}

/// A uniform sampler whose inspected values are the position of the query.
class PlaceSampler final : public test::WrappedSampler {
  public:
    explicit PlaceSampler(const LightTable &lights) : WrappedSampler(uniform_), uniform_(lights.ByComponent()) {}
    void Inspect(const LightQuery &q, std::vector<InspectedValue> &values) const override {
        values.push_back({"x place", double(q.p.x), false});
        values.push_back({"cell", q.p.y > 0 ? 7.0 : 3.0, true});
    }
    std::string DescribeStructure() const override { return "two cells\n"; }

  private:
    std::optional<SampledLight> Choose(const LightQuery &, const void *weights, Float u,
                                       Point2 *uPoint) const override {
        return Inner(weights).Sample(u, uPoint);
    }
    Float Probability(const LightQuery &, const void *weights, LightId light) const override {
        return Inner(weights).PMF(light);
    }
    UniformLightSampler uniform_;
};

class Inspect : public test::FolderTest {
  protected:
    Inspect() {
        built_ = test::BuildText(InspectedScene());
        sampler_ = std::make_unique<PlaceSampler>(built_.scene->Lights());
    }
    Inspection MakeInspection(InspectSettings settings = {}) {
        settings.samples = 4;
        Progress progress;
        return InspectLights(built_, *sampler_, nullptr, settings, progress);
    }
    static double At(const Inspection &inspection, int x, int y, const std::string &layer) {
        int channel = inspection.image.FindChannel(layer);
        EXPECT_GE(channel, 0) << layer;
        return double(inspection.image.Get({x, y}, channel));
    }
    BuiltScene built_;
    std::unique_ptr<PlaceSampler> sampler_;
};

TEST_F(Inspect, HasLayersOfTheGuideAndOfPathLengths) {
    // All light comes from the spot's patch on the ceiling.
    const std::string spot =
        "LightSource 'spot' 'point3 from' [ 0 .6 0 ] 'point3 to' [ 1 2 1 ] 'rgb I' [ 60 60 60 ] 'float coneangle' 32 "
        "'float conedeltaangle' 3";
    Objects world = Objects().Add(spot).Diffuse(".6 .5 .4");
    using namespace test::room;
    for (const char *side : {kCeiling, kBack, kRight, kLeft, kFloor}) world.Quad(side);
    built_ = test::BuildText(SceneText()
                                 .LookAt("0 1.2 -2.8  0 0.8 0  0 1 0")
                                 .Camera(60)
                                 .Film(32, 32)
                                 .Samples(64)
                                 .Integrator("path", 4, "'bool guide' true")
                                 .World(world));
    Progress progress;
    built_.Prepare(progress);
    const RenderSettings settings = built_.Settings();
    RenderWaves(built_.Rendering(progress), settings);
    const LightSampler &lights = *built_.integrator->Lights();
    const Inspection inspection = InspectLights(built_, lights, built_.integrator.get(), {}, progress);
    double share = 0, shines = 0, length = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            share = std::max(share, At(inspection, x, y, "guide.guidingProbability"));
            shines += At(inspection, x, y, "guide.sourceRadiance") > -1;
            length += At(inspection, x, y, "path.vertices") / (32 * 32);
            const double probability = At(inspection, x, y, "guide.continuationProbability");
            EXPECT_TRUE(std::isnan(probability) || (probability >= 0.5 && probability <= 1)) << probability;
        }
    EXPECT_GT(share, 0.2);
    EXPECT_GT(shines, 5);
    EXPECT_GT(length, 2);
    EXPECT_LE(length, 4);
    // An inspection at the light sampler alone has none of this.
    EXPECT_EQ(InspectLights(built_, lights, nullptr, {}, progress).image.FindChannel("path.vertices"), -1);
}

TEST_F(Inspect, PositionsAreThoseOfTheFloor) {
    Inspection inspection = MakeInspection();
    ASSERT_EQ(inspection.image.Resolution(), Point2i(32, 32));
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            bool floor = x >= 8 && x < 24 && y >= 8 && y < 24;
            if (x == 15 || x == 16) continue;  // the wall's upper edge
            ASSERT_EQ(At(inspection, x, y, "hit"), floor) << x << ' ' << y;
            // One pixel is 1/8 wide.
            ASSERT_NEAR(At(inspection, x, y, "sampler.x_place"), floor ? std::abs((x - 15.5) / 8) : 0,
                        std::abs((x - 15.5) / 4) + 1e-3);
        }
    ASSERT_EQ(inspection.layers[0].name, "hit");
    EXPECT_EQ(inspection.structure, "two cells\n");
}

TEST_F(Inspect, SamplersOwnValuesAreThoseOfThePixel) {
    Inspection inspection = MakeInspection();
    double left = At(inspection, 10, 12, "sampler.x_place"), right = At(inspection, 20, 12, "sampler.x_place");
    EXPECT_NEAR(std::abs(left), 5.5 / 8, 1e-3);
    EXPECT_NEAR(std::abs(right), 4.5 / 8, 1e-3);
    EXPECT_LT(left * right, 0);
    EXPECT_NE(At(inspection, 10, 10, "sampler.cell"), At(inspection, 10, 20, "sampler.cell"));
}

TEST_F(Inspect, AMeshIsOneLight) {
    Inspection inspection = MakeInspection();
    ASSERT_EQ(inspection.lights.size(), 3u);
    EXPECT_EQ(inspection.lights[0].first, LightId(0u));
    EXPECT_EQ(inspection.lights[0].count, 2u);
    EXPECT_EQ(inspection.lights[1].first, LightId(2u));
    EXPECT_EQ(inspection.lights[1].count, 1u);
    // The entropy of the probabilities 1/4, 1/4 and 1/2.
    EXPECT_NEAR(At(inspection, 10, 10, "entropy"), 1.5, 1e-6);
}

TEST_F(Inspect, VisibilityAndContributionAreMeasured) {
    Inspection inspection = MakeInspection();
    // The image may be mirrored: the left of the world is where x is negative.
    int lit = At(inspection, 10, 12, "sampler.x_place") < 0 ? 10 : 21, dark = 31 - lit;
    for (int y = 9; y < 23; ++y) {
        EXPECT_EQ(At(inspection, lit, y, "visibility.2"), 1);
        EXPECT_EQ(At(inspection, dark, y, "visibility.2"), 1);
        EXPECT_EQ(At(inspection, lit, y, "visibility.3"), 1);
        EXPECT_EQ(At(inspection, dark, y, "visibility.3"), 0);
        EXPECT_EQ(At(inspection, lit, y, "visibility.0"), 0);
        EXPECT_EQ(At(inspection, lit, y, "brightest"), 3);
        EXPECT_EQ(At(inspection, dark, y, "brightest"), 2);
        EXPECT_NEAR(At(inspection, dark, y, "brightest_probability"), 0.25, 1e-6);
        // Only one light contributes there: it is chosen with probability 1/4 instead of 1.
        EXPECT_NEAR(At(inspection, dark, y, "log10_excess"), std::log10(4.0), 1e-4);
    }
    // For two lights of contributions a and b, chosen with probability 1/4 each, the excess is 4 (a^2 + b^2) / (a +
    // b)^2.
    auto contribution = [&](double x, double y, double lx, double lz, double intensity) {
        double d2 = (x - lx) * (x - lx) + y * y + lz * lz;
        return intensity * lz / (d2 * std::sqrt(d2));
    };
    double x = At(inspection, lit, 12, "sampler.x_place"), y = 3.5 / 8;
    double a = contribution(x, y, 0, 1.5, 1), b = contribution(x, y, -4, 0.5, 400);
    EXPECT_NEAR(At(inspection, lit, 12, "log10_excess"), std::log10(4 * (a * a + b * b) / ((a + b) * (a + b))), 1e-3);
}

TEST_F(Inspect, SameForAnyNumberOfThreads) {
    const auto inspect = [&] { return MakeInspection(); };
    EXPECT_TRUE(test::SameBits(test::OnThreads(1, inspect).image, test::OnThreads(3, inspect).image));
}

TEST_F(Inspect, LightsAreNamedByTheirPlaceInTheSceneFile) {
    Inspection inspection = MakeInspection();
    EXPECT_NE(inspection.lights[0].label.find("AreaLightSource \"diffuse\" at "), std::string::npos)
        << inspection.lights[0].label;
    EXPECT_TRUE(inspection.lights[0].label.ends_with(":11, shape at :12, 2 triangles")) << inspection.lights[0].label;
    EXPECT_TRUE(inspection.lights[1].label.starts_with("LightSource \"point\" at ")) << inspection.lights[1].label;
    EXPECT_TRUE(inspection.lights[1].label.ends_with(":8")) << inspection.lights[1].label;
    EXPECT_EQ(built_.lightNames.Size(), built_.scene->Lights().Size());
    EXPECT_TRUE(built_.lightNames.NameOf(LightId(1u)).ends_with("triangle 2 of 2"));
}

TEST_F(Inspect, TooMuchWorkMeansFewerPixels) {
    InspectSettings settings;
    settings.maxWork = 32 * 32 * (4 + 3 * 4) / 4;
    Inspection inspection = MakeInspection(settings);
    EXPECT_EQ(inspection.stride, 2);
    for (int y = 0; y < 32; y += 2)
        for (int x = 0; x < 32; x += 2)
            for (int c = 1; c < 3; ++c) {
                EXPECT_EQ(inspection.image.Get({x, y}, c), inspection.image.Get({x + 1, y}, c));
                EXPECT_EQ(inspection.image.Get({x, y}, c), inspection.image.Get({x + 1, y + 1}, c));
            }
}

TEST_F(Inspect, WritesEveryLayerWithItsDescription) {
    Inspection inspection = MakeInspection();
    WriteInspection(inspection, folder_.string(), {{"sampler", "telltale"}});
    Image layers = ReadImage(Path("inspect.exr")).image;
    EXPECT_EQ(layers.ChannelCount(), int(inspection.layers.size()));
    nlohmann::json json = nlohmann::json::parse(ReadFileContents(Path("inspect.json")));
    EXPECT_EQ(json["sampler"], "telltale");
    ASSERT_EQ(json["layers"].size(), inspection.layers.size());
    for (const auto &layer : json["layers"]) {
        std::string name = layer["name"];
        int channel = layers.FindChannel(name);
        ASSERT_GE(channel, 0) << name;
        EXPECT_EQ(layers.Get({10, 12}, channel), inspection.image.Get({10, 12}, inspection.image.FindChannel(name)));
        EXPECT_EQ(layer["file"].is_null(), layer["isFlat"].get<bool>()) << name;
        if (!layer["isFlat"]) {
            EXPECT_EQ(ReadImage(Path(layer["file"].get<std::string>())).image.Resolution().x, 32);
        }
        EXPECT_FALSE(layer["meaning"].get<std::string>().empty());
        EXPECT_TRUE(layer["colours"].is_string() || layer["colours"]["brightest"] > layer["colours"]["darkest"])
            << name;
    }
    // The page shows every picture, describes the other layers in words, and names the lights.
    const std::string page = ReadFileContents(Path("index.html"));
    EXPECT_NE(page.find("<p id=\"flat\">"), std::string::npos);
    for (const auto &layer : json["layers"]) {
        const std::string name = layer["name"];
        EXPECT_EQ(page.find("src=\"" + name + ".png\"") != std::string::npos, layer["file"].is_string()) << name;
        EXPECT_EQ(std::filesystem::exists(folder_ / (name + ".png")), layer["file"].is_string()) << name;
    }
    EXPECT_EQ(json["layers"][0]["isFlat"], false);
    // The mesh faces away from everything, the point is seen from everywhere, and the probabilities are uniform.
    test::ExpectWords(page, {"The same everywhere: ", "entropy 1.5", "2 triangles 0;", "2 triangles</td>"});
}

}  // namespace
}  // namespace ext::lab
