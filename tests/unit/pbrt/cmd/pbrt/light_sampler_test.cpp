#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

class LightSamplers : public SmallSceneProgram {
  protected:
    /// Expects values of parameters in the header, to six digits.
    static void ExpectParameters(const ImageFile &file, const std::map<std::string, double> &expected,
                                 const std::string &sampler = "lightSampler") {
        const auto parameters = nlohmann::json::parse(TextOf(file, sampler + ".parameters"));
        for (const auto &[name, value] : expected) EXPECT_NEAR(parameters.at(name).get<double>(), value, 1e-6) << name;
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
    const std::string uniform = SmallScene("'string shootingsampler' 'uniform'");
    Write("named.pbrt", Replaced(uniform, "\"path\"", "\"bdpt\""));
    EXPECT_EQ(TextOf(Render("--spp 1 named.pbrt"), "shootingSampler"), "uniform");
    Write("by-place.pbrt", Replaced(Read("named.pbrt"), "uniform", "exhaustive"));
    ExpectErrors({{"by-place.pbrt", {"by-place.pbrt:5:", "\"exhaustive\" chooses by place"}}});
    PBRT_SKIP_WITHOUT_EXT();
    const ImageFile file = Render("--integrator bdpt --shooting-sampler seen:floor=0.5 scene.pbrt");
    EXPECT_EQ(TextOf(file, "shootingSampler"), "seen");
    ExpectParameters(file, {{"floor", 0.5}}, "shootingSampler");
    ExpectErrors({{"--integrator mlt --shooting-sampler seen:flor=1 scene.pbrt",
                   {"--shooting-sampler:1:5", "did you mean \"floor\"?"}}});
}

TEST_F(LightSamplers, SpecOnTheCommandLineReachesTheSamplerAndTheImage) {
    PBRT_SKIP_WITHOUT_EXT();
    const ImageFile file = Render("--lightsampler octree:model=paper,leaves=512,floor=0.1 scene.pbrt");
    EXPECT_EQ(TextOf(file, "lightSampler"), "octree");
    ExpectParameters(file, {{"leaves", 512}, {"floor", 0.1}, {"depth", 3}});  // the default depth
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
    ExpectErrors({{"--lightsampler octree:floor=0.1,leavs=3 scene.pbrt",
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
    // All mistakes are reported at once.
    ExpectErrors(
        {{"--lightsampler bvh+guide:shre=1 scene.pbrt", {"did you mean \"share\"?", under("bvh+guide:shre=1", 10)}},
         {"--lightsampler octree:x=1,floor=7+guide:y=2 scene.pbrt",
          {"\"x\"", "\"y\"", "at least 0 and at most 1", "3 errors"}}});
}

TEST_F(LightSamplers, ParametersWithoutEffectAreWarnings) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("octree.pbrt", SmallScene("'string lightsampler' 'octree' 'integer octree.leaves' 128"));
    const std::string sampler = "--spp 1 --outfile out.exr scene.pbrt --lightsampler octree:";
    using Words = std::vector<std::string>;
    for (const auto &[arguments, words] :
         {std::pair(sampler + "leaves=1024",
                    Words{"Warning: --lightsampler:1:7: \"leaves\"", "no effect", "model=paper"}),
          {sampler + "model=paper,budget=0.1", {"Warning: --lightsampler:1:19: \"budget\"", "no effect"}},
          {sampler + "depth=2+guide:directions=false,share=0.5",
           {"Warning: --lightsampler:1:38: \"share\"", "directions=true"}},
          {"--spp 1 --outfile out.exr octree.pbrt", {"Warning: octree.pbrt:5:"}}})
        ExpectWords(RunWell(arguments), words);
    for (const char *parameters :
         {"model=paper,leaves=1024", "budget=0.1", "depth=2,floor=0.3", "depth=2+guide:share=0.5"})
        EXPECT_FALSE(Has(RunWell(sampler + parameters), "Warning")) << parameters;
}

TEST_F(LightSamplers, SceneParametersReachTheSampler) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("octree.pbrt",
          SmallScene("'string lightsampler' 'octree' 'integer octree.leaves' 128 'float octree.floor' 0.2"));
    const ImageFile file = Render("octree.pbrt");
    EXPECT_EQ(TextOf(file, "lightSampler"), "octree");
    ExpectParameters(file, {{"leaves", 128}, {"floor", 0.2}});
    // The command line overrides the scene, key by key.
    ExpectParameters(Render("--lightsampler octree:leaves=256 octree.pbrt"), {{"leaves", 256}, {"floor", 0.2}});
    // With another sampler the keys of the scene are not used, and that is no error.
    EXPECT_EQ(TextOf(Render("--lightsampler bvh octree.pbrt"), "lightSampler"), "bvh");
}

TEST_F(LightSamplers, WrongSceneParametersAreErrors) {
    PBRT_SKIP_WITHOUT_EXT();
    const std::string octree = "'string lightsampler' 'octree' ";
    Write("range.pbrt", SmallScene(octree + "'integer octree.leaves' 1"));
    Write("name.pbrt", SmallScene(octree + "'integer octree.leafs' 128"));
    Write("type.pbrt", SmallScene(octree + "'float octree.leaves' 128"));
    ExpectErrors({{"range.pbrt", {"Error: range.pbrt:5:", "leaves", "64", "16777216"}},
                  {"name.pbrt", {"Error: name.pbrt:5:", "octree.leafs", "octree.leaves"}},
                  {"type.pbrt", {"Error: type.pbrt:5:", "octree.leaves", "integer"}}});
}

TEST_F(LightSamplers, MeshLightsGroupTheTrianglesOfAMesh) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("meshlights.pbrt", SmallScene("'bool meshlights' true"));
    for (const char *arguments :
         {"--mesh-lights scene.pbrt", "meshlights.pbrt", "--lightsampler bvh meshlights.pbrt"}) {
        const ImageFile file = Render(arguments);
        EXPECT_EQ(TextOf(file, "lightSampler"), "bvh+meshlights") << arguments;
        EXPECT_EQ(IntOf(file, "lightSampler.lights"), 3) << arguments;
        EXPECT_EQ(IntOf(file, "lightSampler.groups"), 2) << arguments;
    }
    EXPECT_TRUE(Has(Run("--mesh-lights --stats --spp 1 --outfile out.exr scene.pbrt").out, "groups"));
    // The octree has a parameter of its own.
    EXPECT_EQ(TextOf(Render("--lightsampler octree meshlights.pbrt"), "lightSampler"), "octree");
    EXPECT_EQ(TextOf(Render("--lightsampler octree+mesh scene.pbrt"), "lightSampler"), "octree");
    ExpectErrors({{"--mesh-lights --lightsampler octree:meshlights=false scene.pbrt", {"\"meshlights\" is false"}},
                  {"--lightsampler octree:meshlights=false+mesh scene.pbrt", {"\"meshlights\" is false"}}});
}

}  // namespace pbrt::test
