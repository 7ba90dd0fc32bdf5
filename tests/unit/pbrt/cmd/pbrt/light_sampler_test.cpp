#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

class LightSamplers : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", SmallScene());
    }
    nlohmann::json Parameters(const ImageFile &file) const {
        return nlohmann::json::parse(TextOf(file, "lightSampler.parameters"));
    }
};

TEST_F(LightSamplers, EveryListedOneRenders) {
    int count = 0;
    std::istringstream lines(LightSamplerListing());
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == ' ') continue;
        EXPECT_EQ(TextOf(Render("--spp 1 --lightsampler " + line + " scene.pbrt"), "lightSampler"), line);
        ++count;
    }
    EXPECT_GE(count, 4);
}

TEST_F(LightSamplers, LightPathsBeginByAnyThatIsTheSameEverywhere) {
    for (const char *integrator : {"bdpt", "lightpath", "mlt", "sppm"}) {
        const std::string flags = fmt::format("--spp 1 --integrator {} ", integrator);
        EXPECT_EQ(TextOf(Render(flags + "scene.pbrt"), "shootingSampler"), "power");
        EXPECT_EQ(TextOf(Render(flags + "--shooting-sampler uniform scene.pbrt"), "shootingSampler"), "uniform");
    }
    EXPECT_EQ(TextOf(Render("--spp 1 --integrator mlt --lightsampler uniform scene.pbrt"), "lightSampler"), "uniform");
    ExpectErrors({{"--integrator bdpt --shooting-sampler bvh scene.pbrt",
                   {"--shooting-sampler:1:0", "\"bvh\" chooses by place", "valid: power", "uniform"}},
                  {"--integrator bdpt --shooting-sampler powr scene.pbrt", {"did you mean \"power\"?"}},
                  {"--integrator bdpt --shooting-sampler power:x=1 scene.pbrt", {"\"x\"", "it takes none"}},
                  {"--integrator path --shooting-sampler power scene.pbrt", {"bdpt", "sppm", "\"path\""}}});
    const auto named = [](const std::string &sampler) {
        std::string text = SmallScene("\"string shootingsampler\" \"" + sampler + "\"");
        return text.replace(text.find("\"path\""), 6, "\"bdpt\"");
    };
    Write("named.pbrt", named("uniform"));
    EXPECT_EQ(TextOf(Render("--spp 1 named.pbrt"), "shootingSampler"), "uniform");
    Write("by-place.pbrt", named("exhaustive"));
    ExpectErrors({{"by-place.pbrt", {"by-place.pbrt:5:", "\"exhaustive\" chooses by place"}}});
    PBRT_SKIP_WITHOUT_EXT();
    const ImageFile file = Render("--integrator bdpt --shooting-sampler seen:floor=0.5 scene.pbrt");
    EXPECT_EQ(TextOf(file, "shootingSampler"), "seen");
    EXPECT_NEAR(nlohmann::json::parse(TextOf(file, "shootingSampler.parameters")).at("floor").get<double>(), 0.5, 1e-6);
    ExpectErrors({{"--integrator mlt --shooting-sampler seen:flor=1 scene.pbrt",
                   {"--shooting-sampler:1:5", "did you mean \"floor\"?"}}});
}

TEST_F(LightSamplers, SpecOnTheCommandLineReachesTheSamplerAndTheImage) {
    PBRT_SKIP_WITHOUT_EXT();
    const ImageFile file = Render("--lightsampler octree:model=paper,leaves=512,floor=0.1 scene.pbrt");
    EXPECT_EQ(TextOf(file, "lightSampler"), "octree");
    EXPECT_EQ(Parameters(file).at("leaves"), 512);
    EXPECT_NEAR(Parameters(file).at("floor").get<double>(), 0.1, 1e-6);
    EXPECT_EQ(Parameters(file).at("depth"), 3) << "a parameter that is not given has its default";
    EXPECT_GE(IntOf(file, "lightSampler.leaves"), 64);
    EXPECT_GT(IntOf(file, "lightSampler.bytes"), 0);
    EXPECT_GT(NumberOf(file, "lightSampler.prepassSeconds"), 0);
    EXPECT_GT(NumberOf(file, "lightSampler.octreeBuildSeconds"), 0);
    EXPECT_EQ(IntOf(file, "lightSampler.lights"), 3);
    EXPECT_EQ(IntOf(file, "lightSampler.groups"), 2) << "the two triangles are one group";
    EXPECT_LT(IntOf(Render("--lightsampler octree:model=paper,leaves=64 scene.pbrt"), "lightSampler.leaves"),
              IntOf(Render("--lightsampler octree:model=paper,leaves=4096 scene.pbrt"), "lightSampler.leaves"));
}

TEST_F(LightSamplers, WrongSpecsAreShownWithTheChoices) {
    ExpectErrors(
        {{"--lightsampler bhv scene.pbrt", {"--lightsampler:1:0", "\"bhv\"", "valid: bvh", "uniform", "power"}},
         {"--lightsampler bvh:x=1 scene.pbrt", {"--lightsampler:1:4", "\"x\"", "it takes none"}}});
    PBRT_SKIP_WITHOUT_EXT();
    ExpectErrors({{"--lightsampler octre scene.pbrt", {"did you mean \"octree\"?"}},
                  {"--lightsampler octree:floor=0.1,leavs=3 scene.pbrt",
                   {"--lightsampler:1:17", "\"leavs\"", "did you mean \"leaves\"?", "prepassspp",
                    fmt::format("\n    octree:floor=0.1,leavs=3\n    {:>18}", "^")}},
                  {"--lightsampler octree:leaves=many scene.pbrt", {"--lightsampler:1:14", "\"many\"", "integer"}},
                  {"--lightsampler octree:meshlights=yes scene.pbrt", {"\"yes\"", "bool"}},
                  {"--lightsampler octree:leaves scene.pbrt", {"\"leaves=value\""}},
                  {"--lightsampler octree: scene.pbrt", {"leaves"}},
                  {"--lightsampler octree:leaves=63 scene.pbrt", {"--lightsampler:1:7", "63", "64", "16777216"}},
                  {"--lightsampler octree:model=papr scene.pbrt", {"papr", "visibility", "paper"}},
                  {"--lightsampler octree:floor=nan scene.pbrt", {"floor"}}});
}

TEST_F(LightSamplers, SuffixesAndOldFlagsAreOneLanguage) {
    const ImageFile suffixes = Render("--spp 1 --lightsampler bvh+mesh scene.pbrt");
    EXPECT_EQ(TextOf(suffixes, "lightSampler"), "bvh+meshlights");
    EXPECT_TRUE(SamePixels(suffixes, Render("--spp 1 --lightsampler bvh --mesh-lights scene.pbrt")));
}

TEST_F(LightSamplers, CaretsStandUnderTheMistakeInTheWholeFlag) {
    auto under = [](const std::string &text, size_t column) {
        return "\n    " + text + "\n    " + std::string(column, ' ') + "^";
    };
    ExpectErrors(
        {{"--lightsampler bvh+mush scene.pbrt", {"\"+mush\"", "+mesh", under("bvh+mush", 3)}},
         {"--lightsampler bvh+gate=neepp scene.pbrt", {"\"+gate=neepp\"", "+mesh", under("bvh+gate=neepp", 3)}}});
    PBRT_SKIP_WITHOUT_EXT();
    ExpectErrors(
        {{"--lightsampler bvh+guide:shre=1 scene.pbrt", {"did you mean \"share\"?", under("bvh+guide:shre=1", 10)}}});
    // All mistakes are reported at once.
    ExpectErrors({{"--lightsampler octree:x=1,floor=7+guide:y=2 scene.pbrt",
                   {"\"x\"", "\"y\"", "at least 0 and at most 1", "3 errors"}}});
}

TEST_F(LightSamplers, ParametersWithoutEffectAreWarnings) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("octree.pbrt", SmallScene(R"("string lightsampler" "octree" "integer octree.leaves" 128)"));
    for (auto [arguments, warning] :
         {std::pair("--lightsampler octree:leaves=1024 scene.pbrt",
                    "Warning: --lightsampler:1:7: \"leaves\" has no effect: it belongs to model=paper"),
          std::pair("--lightsampler octree:model=paper,budget=0.1 scene.pbrt",
                    "Warning: --lightsampler:1:19: \"budget\" has no effect"),
          std::pair("octree.pbrt", "Warning: octree.pbrt:5:")})
        EXPECT_TRUE(Has(RunWell(std::string("--spp 1 --outfile out.exr ") + arguments), warning)) << arguments;
    for (const char *arguments : {"octree:model=paper,leaves=1024", "octree:budget=0.1", "octree:depth=2,floor=0.3"})
        EXPECT_FALSE(
            Has(RunWell(std::string("--spp 1 --outfile out.exr scene.pbrt --lightsampler ") + arguments), "Warning"))
            << arguments;
}

TEST_F(LightSamplers, SceneParametersReachTheSampler) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("octree.pbrt",
          SmallScene(R"("string lightsampler" "octree" "integer octree.leaves" 128 "float octree.floor" 0.2)"));
    const ImageFile file = Render("octree.pbrt");
    EXPECT_EQ(TextOf(file, "lightSampler"), "octree");
    EXPECT_EQ(Parameters(file).at("leaves"), 128);
    EXPECT_NEAR(Parameters(file).at("floor").get<double>(), 0.2, 1e-6);

    // The command line overrides the scene, key by key.
    const ImageFile both = Render("--lightsampler octree:leaves=256 octree.pbrt");
    EXPECT_EQ(Parameters(both).at("leaves"), 256);
    EXPECT_NEAR(Parameters(both).at("floor").get<double>(), 0.2, 1e-6);

    // With another sampler the keys of the scene are not used, and that is no error.
    EXPECT_EQ(TextOf(Render("--lightsampler bvh octree.pbrt"), "lightSampler"), "bvh");
}

TEST_F(LightSamplers, WrongSceneParametersAreErrors) {
    PBRT_SKIP_WITHOUT_EXT();
    std::vector<ErrorCase> cases;
    for (const auto &[parameter, parts] :
         {std::pair(R"("integer octree.leaves" 1)", std::vector<std::string>{"leaves", "64", "16777216"}),
          {R"("integer octree.leafs" 128)", {"octree.leafs", "octree.leaves"}},
          {R"("float octree.leaves" 128)", {"octree.leaves", "integer"}}}) {
        const std::string name = std::to_string(cases.size()) + ".pbrt";
        Write(name, SmallScene(std::string(R"("string lightsampler" "octree" )") + parameter));
        cases.push_back({name, parts});
        cases.back().parts.push_back("Error: " + name + ":5:");
    }
    ExpectErrors(cases);
}

TEST_F(LightSamplers, MeshLightsGroupTheTrianglesOfAMesh) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("meshlights.pbrt", SmallScene(R"("bool meshlights" true)"));
    for (const char *arguments :
         {"--mesh-lights scene.pbrt", "meshlights.pbrt", "--lightsampler bvh meshlights.pbrt"}) {
        const ImageFile file = Render(arguments);
        EXPECT_EQ(TextOf(file, "lightSampler"), "bvh+meshlights") << arguments;
        EXPECT_EQ(IntOf(file, "lightSampler.lights"), 3) << arguments;
        EXPECT_EQ(IntOf(file, "lightSampler.groups"), 2) << arguments;
    }
    EXPECT_TRUE(Has(Run("--mesh-lights --stats --spp 1 --outfile out.exr scene.pbrt").out, "groups"));
    EXPECT_EQ(TextOf(Render("--mesh-lights --lightsampler octree scene.pbrt"), "lightSampler"), "octree")
        << "the octree groups the triangles anyway, without the suffix";
}

}  // namespace pbrt::test
