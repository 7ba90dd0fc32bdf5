#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

namespace {

const std::string kSuite = PBRT_SOURCE_DIR "/tests/conformance/suite/";

struct ErrorScene {
    std::string name, file;
    bool isRendered = false;
    int line = 0;  ///< 0: the suite gives no line
};

void PrintTo(const ErrorScene &scene, std::ostream *out) { *out << scene.name; }

std::vector<ErrorScene> ErrorScenes() {
    std::vector<ErrorScene> scenes;
    std::ifstream in(kSuite + "manifest.json");
    for (const nlohmann::json &entry : nlohmann::json::parse(in)) {
        if (entry.at("category") != "errors") continue;
        const nlohmann::json &expected = entry.at("expected");
        scenes.push_back({entry.at("name"), kSuite + entry.at("scene").get<std::string>(),
                          expected.at("exit") == "zero",
                          expected.at("line").is_null() ? 0 : expected.at("line").get<int>()});
    }
    return scenes;
}

/// True if `text` has "Error: file:line:column: message", the quoted line, and a caret under it.
bool HasDiagnostic(const std::string &text, const std::string &start) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    for (size_t i = 0; i + 2 < lines.size(); ++i) {
        const std::string &caret = lines[i + 2];
        if (lines[i].starts_with(start) && lines[i + 1].starts_with("    ") && !caret.empty() && caret.back() == '^' &&
            caret.find_first_not_of(' ') == caret.size() - 1 && caret.size() <= lines[i + 1].size() + 1)
            return true;
    }
    return false;
}

}  // namespace

class ErrorScenesProgram : public Program, public ::testing::WithParamInterface<ErrorScene> {};

TEST_P(ErrorScenesProgram, EndAsTheManifestStates) {
    const ErrorScene &scene = GetParam();
    ASSERT_TRUE(std::filesystem::exists(scene.file));
    std::string place = scene.file + ":";
    if (scene.line) place.append(std::to_string(scene.line)).append(":");
    const std::string arguments = "--spp 1 --cropwindow 0,0.5,0,0.5 --outfile out.exr " + scene.file;
    if (scene.isRendered) {
        const std::string messages = RunWell(arguments);
        EXPECT_TRUE(HasDiagnostic(messages, "Warning: " + place)) << messages;
        EXPECT_EQ(Files(), std::vector<std::string>{"out.exr"});
        EXPECT_EQ(ReadImage(Path("out.exr")).image.Resolution(), Point2i(8, 8));
    } else {
        const Outcome o = Run("--quiet " + arguments);
        EXPECT_EQ(o.status, 1);
        EXPECT_EQ(o.out, "");
        EXPECT_TRUE(o.err.starts_with("Error: " + place)) << o.err;
        EXPECT_TRUE(!scene.line || HasDiagnostic(o.err, "Error: " + place)) << o.err;
        EXPECT_EQ(Files(), std::vector<std::string>{});
    }
}

INSTANTIATE_TEST_SUITE_P(Suite, ErrorScenesProgram, ::testing::ValuesIn(ErrorScenes()),
                         [](const auto &scene) { return scene.param.name; });

TEST(ErrorSuite, HasScenesOfBothKinds) {
    const std::vector<ErrorScene> scenes = ErrorScenes();
    EXPECT_GE(scenes.size(), 39u);
    EXPECT_GE(std::count_if(scenes.begin(), scenes.end(), [](const ErrorScene &s) { return s.isRendered; }), 6);
}

class Errors : public Program {};

TEST_F(Errors, EveryMistakeIsReportedInOneRun) {
    Write("scene.pbrt", SceneText()
                            .Camera("perspective")
                            .Film(16, 16)
                            .World(Objects()
                                       .Add("MakeNamedMedium 'fog' 'string type' 'homogenous'")
                                       .Light("point")
                                       .Material("diffuse", "'texture reflectance' 'nosuch'")
                                       .Shape("sphere")
                                       .Material("diffuse")
                                       .Shape("bilinearmesh",
                                              "'string emissionfilename' 'e.png' "
                                              "'point3 P' [ 0 0 0  1 0 0  0 1 0  1 1 0 ]")
                                       .Shape("sphere", "'float radiuss' 1")
                                       .Sphere(2)));
    const Outcome o = Run("--quiet --outfile out.exr scene.pbrt");
    SCOPED_TRACE(o.err);
    EXPECT_EQ(o.status, 1);
    for (const char *place : {"4:0", "6:19", "9:21", "10:15"})
        EXPECT_TRUE(HasDiagnostic(o.err, fmt::format("Error: scene.pbrt:{}: ", place))) << place;
    EXPECT_EQ(CountOf(o.err, "Error: "), 4u);
    ExpectWords(o.err, {"4 errors; nothing was rendered."});
    EXPECT_EQ(Files(), std::vector<std::string>{"scene.pbrt"});
}

TEST_F(Errors, EverythingBeforeTheWorldIsCheckedInOneRun) {
    const Objects world = Objects().Light("point").Sphere();
    Write("names.pbrt", SceneText()
                            .Head("Film 'rgbb'\nCamera 'perspektive'\nSampler 'sobl'\nPixelFilter 'gauss'\n"
                                  "Integrator 'pat'\nAccelerator 'bhv'")
                            .World(world));
    Write("parameters.pbrt", SceneText()
                                 .Head("Film 'rgb' 'integer xres' 4\nCamera 'perspective' 'float fow' 1\n"
                                       "Sampler 'sobol' 'integer samples' 1\nPixelFilter 'box' 'float radius' 1\n"
                                       "Integrator 'path' 'integer maxdepht' 1 'string lightsampler' 'bhv'\n"
                                       "Accelerator 'bvh' 'integer prims' 1")
                                 .World(world));
    for (const std::string scene : {"names.pbrt", "parameters.pbrt"}) {
        const Outcome o = Run("--quiet --outfile nowhere/out.exr " + scene);
        SCOPED_TRACE(o.err);
        EXPECT_EQ(o.status, 1);
        for (int line = 1; line <= 6; ++line)
            EXPECT_TRUE(HasDiagnostic(o.err, fmt::format("Error: {}:{}:", scene, line))) << line;
        ExpectWords(o.err, {"folder nowhere"});
        EXPECT_EQ(CountOf(o.err, "Error: "), scene == "names.pbrt" ? 7u : 8u);
    }
}

TEST_F(Errors, UnwritableOutputIsReportedBeforeTheSceneIsBuilt) {
    // Only building finds that this file is missing, so it is not named where something is wrong before.
    Write("scene.pbrt",
          SceneText().Head("Film 'rgb'").World(Objects().Shape("plymesh", "'string filename' 'none.ply'")));
    ExpectErrors({{"--outfile out.exr scene.pbrt", {"none.ply"}}});
    for (const char *folder : {"folder.exr", "locked"}) std::filesystem::create_directory(Path(folder));
    std::filesystem::permissions(Path("locked"),
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    std::vector<std::pair<std::string, std::string>> cases = {
        {"--outfile nowhere/out.exr", "folder nowhere"},
        {"--outfile out.bmp", ".exr, .png or .pfm"},
        {"--outfile folder.exr", "is a folder"},
        {"--lightsampler bvh:x=1", "it takes none"},
        {"--mse-reference-image none.exr --mse-reference-out mse.txt", "none.exr"}};
    if (geteuid() != 0) cases.emplace_back("--outfile locked/out.exr", "not writable");
    for (const auto &[arguments, error] : cases) {
        const Outcome o = Run(arguments + " scene.pbrt");
        SCOPED_TRACE(arguments + "\n" + o.err);
        EXPECT_EQ(o.status, 1);
        EXPECT_TRUE(Has(o.err, error));
        EXPECT_EQ(CountOf(o.err, "Error: "), 1u);
        EXPECT_FALSE(Has(o.err, "none.ply"));
    }
}

TEST_F(Errors, WhatOnlyTheWholeSceneShowsHasAPlace) {
    const std::string lens = "Camera 'realistic' 'string lensfile' '" + kSuite + "scenes/assets/lens_symmetric.dat'\n",
                      world = "WorldBegin\nShape 'sphere'\n";
    Write("lens.pbrt", Quoted(lens + "Film 'rgb'\nIntegrator 'bdpt'\n" + world));
    Write("path.pbrt", Quoted(lens + "Film 'rgb'\nIntegrator 'path'\n" + world));
    Write("one.pbrt", Quoted("Film 'rgb'\nOption 'msereferenceimage' 'a.exr'\n" + world));
    Write("none.pbrt",
          Quoted("Film 'rgb'\nOption 'msereferenceout' 'mse.txt'\nOption 'msereferenceimage' 'none.exr'\n" + world));
    Write("nowhere.pbrt", Quoted("Film 'rgb' 'string filename' 'nowhere/a.exr'\n" + world));
    ExpectErrors({{"lens.pbrt", {"Error: lens.pbrt:3:0: ", "follows light to the camera", "^"}},
                  {"--integrator bdpt path.pbrt", {"Error: --integrator:1:0: ", "follows light to the camera", "^"}},
                  {"one.pbrt", {"Error: one.pbrt:2:7: ", "needs both", "^"}},
                  {"none.pbrt", {"Error: none.pbrt:3:7: ", "none.exr: the reference image", "^"}},
                  {"nowhere.pbrt", {"Error: nowhere.pbrt:1:", "folder nowhere", "^"}}});
}

TEST_F(Errors, EverythingUnsupportedIsListedOnceBeforeRendering) {
    Write("scene.pbrt", SceneText()
                            .Head("Film 'rgb'")
                            .Integrator("function")
                            .World(Objects()
                                       .Add("Texture 'skin' 'spectrum' 'ptex' 'string filename' 'skin.ptx'")
                                       .Add("Texture 'wood' 'spectrum' 'ptex' 'string filename' 'wood.ptx'")
                                       .Sphere()));
    const Outcome o = Run("--quiet --outfile out.exr scene.pbrt");
    SCOPED_TRACE(o.err);
    EXPECT_EQ(o.status, 1);
    for (int line : {2, 4, 5}) EXPECT_EQ(CountOf(o.err, fmt::format("Error: scene.pbrt:{}:", line)), 1u) << line;
    EXPECT_EQ(CountOf(o.err, "Error: "), 3u);
    EXPECT_EQ(CountOf(o.err, "is not supported"), 3u);
    EXPECT_EQ(CountOf(o.err, "--integrator path"), 1u);
    EXPECT_EQ(Files(), std::vector<std::string>{"scene.pbrt"});
}

TEST_F(Errors, WhatPhotonMapsAndChainsCannotDo) {
    const auto write = [&](const std::string &name, const std::string &integrator) {
        Write(name, Replaced(SmallScene(), Quoted("'path' 'integer maxdepth' 3"), Quoted(integrator)));
    };
    write("many.pbrt", "'sppm' 'integer photonsperiteration' 2147483647");
    write("radius.pbrt", "'sppm' 'float radius' 0");
    write("chains.pbrt", "'mlt' 'integer chains' 0");
    write("mlt.pbrt", "'mlt' 'integer mutationsperpixel' 3");
    ExpectErrors({{"many.pbrt", {"2147483647 photons"}},
                  {"radius.pbrt", {"Error: radius.pbrt:", "\"radius\" is 0", "^"}},
                  {"chains.pbrt", {"Error: chains.pbrt:", "\"chains\" is 0", "^"}},
                  {"--aov albedo mlt.pbrt", {"\"rgb\"", "\"spectral\""}}});
    EXPECT_EQ(IntOf(Render("mlt.pbrt"), "samplesPerPixel"), 3);
    EXPECT_EQ(IntOf(Render("mlt.pbrt --spp 2"), "samplesPerPixel"), 2);
}

TEST_F(Errors, LightSamplersAreWrittenWithAColon) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", SmallScene());
    Write("name.pbrt", SmallScene("'string lightsampler' 'octree:floor=0.1'"));
    std::vector<ErrorCase> cases = {
        {"--lightsampler 'octree:floor=0.1;leaves=3' scene.pbrt", {"\"0.1;leaves=3\"", "commas separate parameters"}},
        {"--lightsampler 'octre,floor=0.1' scene.pbrt", {"\"octre\"", "did you mean \"octree\"?"}},
        {"--lightsampler octree:floor=.1,floor=.2 scene.pbrt",
         {"--lightsampler:1:16", "\"octree.floor\" is given twice", "^"}},
        {"--lightsampler octree+mesh+mesh scene.pbrt", {"--lightsampler:1:11", "\"+mesh\" is given twice", "^"}},
        {"--lightsampler octree+guide+guide:share=0.5 scene.pbrt",
         {"--lightsampler:1:12", "\"+guide\" is given twice", "^"}},
        {"name.pbrt", {"Error: name.pbrt:5:", "is the form of flags", "\"float octree.floor\"", "^"}}};
    for (const char *separator : {",", ";", "=", " ", "/"})
        cases.push_back({std::string("--lightsampler 'octree") + separator + "floor=0.1' scene.pbrt",
                         {"--lightsampler:1:6", "a colon separates", "\"octree:floor=0.1\"", "^"}});
    ExpectErrors(cases);
}

TEST_F(Errors, NamesOfVersion3HaveAHint) {
    const SceneText scene = SceneText().Head("Film 'rgb' 'string filename' 'out.exr'");
    const auto before = [&](const std::string &directive) { return SceneText(scene).Head(directive).World(); };
    const auto in = [&](const std::string &directives) { return scene.World(Objects().Add(directives)); };
    const std::vector<std::pair<std::string, std::string>> cases = {
        {in("Shape 'sphere'\nWorldEnd"), "WorldEnd; it is of pbrt-v3: delete it"},
        {in("Material 'matte' Shape 'sphere'"), "use 'diffuse' with 'reflectance'"},
        {in("Material 'uber' Shape 'sphere'"), "use 'coateddiffuse'"},
        {in("Material 'diffuse' 'rgb Kd' [ 1 1 1 ] Shape 'sphere'"), "use 'reflectance'"},
        {in("MakeNamedMaterial 'm' 'string type' 'mirror'"), "use 'conductor'"},
        {in("Shape 'cone'"), "use 'trianglemesh' or 'plymesh'"},
        {in("LightSource 'infinite' 'string mapname' 'a.exr'"), "use 'filename'"},
        {in("LightSource 'point' 'color I' [ 1 1 1 ]"), "write 'rgb'"},
        {in("Texture 't' 'color' 'constant'"), "write 'spectrum'"},
        {SceneText().Head("Film 'image'").World(), "use 'rgb'"},
        {before("Sampler '02sequence'"), "use 'paddedsobol'"},
        {before("SurfaceIntegrator 'path'"), "use 'Integrator'"},
        {before("Integrator 'directlighting'"), "'path' with 'integer maxdepth' 1"},
        {before("Camera 'environment'"), "use 'spherical'"}};
    std::vector<ErrorCase> runs;
    for (const auto &[text, hint] : cases) {
        const std::string name = "v3-" + std::to_string(runs.size()) + ".pbrt";
        Write(name, text);
        runs.push_back({name, {"Error: " + name + ":", "it is of pbrt-v3: ", Quoted(hint), "--upgrade", "^"}});
    }
    ExpectErrors(runs);
    Write("no.pbrt", in("Material 'mate'"));
    EXPECT_FALSE(Has(Run("no.pbrt").err, "v3"));
}

TEST_F(Errors, OldNamesHaveAHint) {
    const std::string removed = "it was removed (docs/develop/negative-results.md)";
    Write("scene.pbrt", SmallScene());
    std::vector<ErrorCase> cases = {{"--shadow-gate neepp scene.pbrt", {"--shadow-gate: " + removed}},
                                    {"--lightsampler bvh+gate=neepp scene.pbrt", {"--lightsampler:1:3", removed, "^"}}};
    for (const auto &[parameter, hint] :
         {std::pair("string octree.windows", Quoted("it is 'string octree.portals' now")),
          {"bool octree.tiles", removed},
          {"bool octree.opensky", removed},
          {"bool equiangular", removed},
          {"string shadowgate", removed}}) {
        const std::string name = fmt::format("old-{}.pbrt", cases.size());
        const char *value = std::string_view(parameter).starts_with("bool") ? "true" : "'always'";
        Write(name, SmallScene(fmt::format("'{}' {}", parameter, value)));
        cases.push_back({name, {"Error: " + name + ":5:", Quoted(fmt::format("'{}'", parameter)), hint, "^"}});
    }
    ExpectErrors(cases);
    if (HasExt())
        ExpectErrors({{"--lightsampler octree:windows=always scene.pbrt",
                       {"--lightsampler:1:7", Quoted("it is 'string octree.portals' now"), "^"}}});
}

}  // namespace pbrt::test
