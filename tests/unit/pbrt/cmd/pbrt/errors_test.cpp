#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

namespace {

const std::string kSuite = PBRT_SOURCE_DIR "/tests/conformance/suite/";

struct ErrorScene {
    std::string name, file;
    bool survives = false;
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

std::vector<std::string> Lines(const std::string &text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// True if `text` has "Error: file:line:column: message", the quoted line, and a caret under it.
bool HasDiagnostic(const std::string &text, const std::string &start) {
    const std::vector<std::string> lines = Lines(text);
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

TEST_P(ErrorScenesProgram, EndAsTheSuiteSays) {
    const ErrorScene &scene = GetParam();
    ASSERT_TRUE(std::filesystem::exists(scene.file));
    std::string place = scene.file + ":";
    if (scene.line) place.append(std::to_string(scene.line)).append(":");
    const std::string arguments = "--spp 1 --cropwindow 0,0.5,0,0.5 --outfile out.exr " + scene.file;
    if (scene.survives) {
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
    EXPECT_GE(std::count_if(scenes.begin(), scenes.end(), [](const ErrorScene &s) { return s.survives; }), 6);
}

class Errors : public Program {};

TEST_F(Errors, EveryMistakeIsReportedInOneRun) {
    Write("scene.pbrt", R"(Camera "perspective"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
MakeNamedMedium "fog" "string type" "homogenous"
LightSource "point"
Material "diffuse" "texture reflectance" "nosuch"
Shape "sphere"
Material "diffuse"
Shape "bilinearmesh" "string emissionfilename" "e.png" "point3 P" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]
Shape "sphere" "float radiuss" 1
Shape "sphere" "float radius" 2
)");
    const Outcome o = Run("--quiet --outfile out.exr scene.pbrt");
    EXPECT_EQ(o.status, 1);
    for (const char *place : {"4:0", "6:19", "9:21", "10:15"})
        EXPECT_TRUE(HasDiagnostic(o.err, std::string("Error: scene.pbrt:") + place + ": ")) << place << "\n" << o.err;
    EXPECT_EQ(CountOf(o.err, "Error: "), 4u) << o.err;
    EXPECT_TRUE(Has(o.err, "4 errors; nothing was rendered.")) << o.err;
    EXPECT_EQ(Files(), std::vector<std::string>{"scene.pbrt"});
}

TEST_F(Errors, EverythingBeforeTheWorldIsCheckedInOneRun) {
    const std::string world = "WorldBegin\nLightSource \"point\"\nShape \"sphere\"\n";
    Write("names.pbrt", R"(Film "rgbb"
Camera "perspektive"
Sampler "sobl"
PixelFilter "gauss"
Integrator "pat"
Accelerator "bhv"
)" + world);
    Write("parameters.pbrt", R"(Film "rgb" "integer xres" 4
Camera "perspective" "float fow" 1
Sampler "sobol" "integer samples" 1
PixelFilter "box" "float radius" 1
Integrator "path" "integer maxdepht" 1 "string lightsampler" "bhv"
Accelerator "bvh" "integer prims" 1
)" + world);
    for (const char *scene : {"names.pbrt", "parameters.pbrt"}) {
        const Outcome o = Run(std::string("--quiet --outfile nowhere/out.exr ") + scene);
        EXPECT_EQ(o.status, 1);
        for (int line = 1; line <= 6; ++line)
            EXPECT_TRUE(HasDiagnostic(o.err, "Error: " + std::string(scene) + ":" + std::to_string(line) + ":"))
                << line << "\n"
                << o.err;
        EXPECT_TRUE(Has(o.err, "folder nowhere")) << o.err;
        EXPECT_EQ(CountOf(o.err, "Error: "), scene == std::string("names.pbrt") ? 7u : 8u) << o.err;
    }
}

TEST_F(Errors, WhatCannotBeWrittenIsFoundBeforeTheSceneIsBuilt) {
    // Only building finds that this file is missing, so it is not named where something is wrong before.
    Write("scene.pbrt", "Film \"rgb\"\nWorldBegin\nShape \"plymesh\" \"string filename\" \"none.ply\"\n");
    ExpectErrors({{"--outfile out.exr scene.pbrt", {"none.ply"}}});
    std::filesystem::create_directory(Path("folder.exr"));
    std::filesystem::create_directory(Path("locked"));
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

TEST_F(Errors, EverythingUnsupportedIsListedOnceBeforeRendering) {
    Write("scene.pbrt", R"(Camera "perspective"
Film "rgb"
Sampler "zsobol"
Integrator "function"
WorldBegin
Texture "skin" "spectrum" "ptex" "string filename" "skin.ptx"
Texture "wood" "spectrum" "ptex" "string filename" "wood.ptx"
Shape "sphere"
)");
    const Outcome o = Run("--quiet --outfile out.exr scene.pbrt");
    EXPECT_EQ(o.status, 1);
    for (int line : {4, 6, 7})
        EXPECT_EQ(CountOf(o.err, "Error: scene.pbrt:" + std::to_string(line) + ":"), 1u) << line << "\n" << o.err;
    EXPECT_EQ(CountOf(o.err, "Error: "), 3u) << o.err;
    EXPECT_EQ(CountOf(o.err, "is not supported"), 3u) << o.err;
    EXPECT_EQ(CountOf(o.err, "--integrator path"), 1u) << o.err;
    EXPECT_EQ(Files(), std::vector<std::string>{"scene.pbrt"});
}

TEST_F(Errors, WhatPhotonMapsAndChainsCannotDo) {
    const std::string scene = SmallScene();
    const size_t begin = scene.find("Integrator"), end = scene.find('\n', begin);
    ASSERT_NE(begin, std::string::npos);
    const auto with = [&](const std::string &integrator) {
        return scene.substr(0, begin) + integrator + scene.substr(end);
    };
    Write("many.pbrt", with("Integrator \"sppm\" \"integer photonsperiteration\" 2147483647"));
    Write("radius.pbrt", with("Integrator \"sppm\" \"float radius\" 0"));
    Write("chains.pbrt", with("Integrator \"mlt\" \"integer chains\" 0"));
    Write("mlt.pbrt", with("Integrator \"mlt\" \"integer mutationsperpixel\" 3"));
    ExpectErrors({{"many.pbrt", {"a map of 2147483647 photons needs about"}},
                  {"radius.pbrt", {"Error: radius.pbrt:", "\"radius\" is 0", "^"}},
                  {"chains.pbrt", {"Error: chains.pbrt:", "\"chains\" is 0", "^"}},
                  {"--aov albedo mlt.pbrt", {"use Film \"rgb\" or \"spectral\""}}});
    EXPECT_EQ(IntOf(Render("mlt.pbrt"), "samplesPerPixel"), 3);
    EXPECT_EQ(IntOf(Render("mlt.pbrt --spp 2"), "samplesPerPixel"), 2);
}

TEST_F(Errors, LightSamplersAreWrittenWithAColon) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", SmallScene());
    Write("name.pbrt", SmallScene(R"("string lightsampler" "octree:floor=0.1")"));
    std::vector<ErrorCase> cases = {
        {"--lightsampler 'octree:floor=0.1;leaves=3' scene.pbrt", {"\"0.1;leaves=3\"", "commas separate parameters"}},
        {"--lightsampler 'octre,floor=0.1' scene.pbrt", {"\"octre\" is unknown; did you mean \"octree\"?"}},
        {"name.pbrt", {"Error: name.pbrt:5:", "is the form of flags", "\"float octree.floor\"", "^"}}};
    for (const char *separator : {",", ";", "=", " ", "/"})
        cases.push_back({std::string("--lightsampler 'octree") + separator + "floor=0.1' scene.pbrt",
                         {"--lightsampler:1:6", "a colon separates", "\"octree:floor=0.1\"", "^"}});
    ExpectErrors(cases);
}

TEST_F(Errors, NamesOfVersion3HaveAHint) {
    const std::string options = "Film \"rgb\" \"string filename\" \"out.exr\"\n", world = "WorldBegin\n";
    const std::map<std::string, std::string> cases = {
        {options + world + "Shape \"sphere\"\nWorldEnd\n", "WorldEnd; it is of pbrt-v3: delete it"},
        {options + world + "Material \"matte\" Shape \"sphere\"\n", "use \"diffuse\" with \"reflectance\""},
        {options + world + "Material \"uber\" Shape \"sphere\"\n", "use \"coateddiffuse\""},
        {options + world + "Material \"glass\" Shape \"sphere\"\n", "use \"dielectric\""},
        {options + world + "Material \"diffuse\" \"rgb Kd\" [ 1 1 1 ] Shape \"sphere\"\n", "use \"reflectance\""},
        {options + world + "MakeNamedMaterial \"m\" \"string type\" \"mirror\"\n", "use \"conductor\""},
        {options + world + "Shape \"cone\"\n", "use \"trianglemesh\" or \"plymesh\""},
        {options + world + "LightSource \"infinite\" \"string mapname\" \"a.exr\"\n", "use \"filename\""},
        {options + world + "LightSource \"point\" \"color I\" [ 1 1 1 ]\n", "write \"rgb\""},
        {options + world + "LightSource \"point\" \"point from\" [ 1 1 1 ]\n", "write \"point3\""},
        {options + world + "Texture \"t\" \"color\" \"constant\"\n", "write \"spectrum\""},
        {"Film \"image\"\n" + world, "use \"rgb\""},
        {options + "Sampler \"lowdiscrepancy\"\n" + world, "use \"zsobol\""},
        {options + "Sampler \"02sequence\"\n" + world, "use \"paddedsobol\""},
        {options + "SurfaceIntegrator \"path\"\n" + world, "use \"Integrator\""},
        {options + "Integrator \"directlighting\"\n" + world, "\"path\" with \"integer maxdepth\" 1"},
        {options + "Camera \"environment\"\n" + world, "use \"spherical\""}};
    std::vector<ErrorCase> runs;
    for (const auto &[text, hint] : cases) {
        const std::string name = "v3-" + std::to_string(runs.size()) + ".pbrt";
        Write(name, text);
        runs.push_back({name, {"Error: " + name + ":", "it is of pbrt-v3: ", hint, "--upgrade", "^"}});
    }
    ExpectErrors(runs);
    Write("no.pbrt", options + world + "Material \"mate\"\n");
    EXPECT_FALSE(Has(Run("no.pbrt").err, "v3"));
}

TEST_F(Errors, MissingSceneFileIsNamed) {
    ExpectErrors({{"nowhere.pbrt", {"nowhere.pbrt", "No such file or directory"}}, {".", {"is a directory"}}});
}

}  // namespace pbrt::test
