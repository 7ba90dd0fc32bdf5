#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "program.h"

namespace pbrt::test {

class Flags : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", SmallScene());
    }
};

TEST_F(Flags, SpellingOfNamesIsFree) {
    for (const char *arguments : {"--spp 2 --outfile out.exr", "-spp 2 -outfile out.exr", "--spp=2 --outfile=out.exr",
                                  "-SPP=2 --Out_File out.exr", "--s-p-p 2 -OUT-file=out.exr"}) {
        RunWell(std::string(arguments) + " scene.pbrt");
        ASSERT_TRUE(Exists("out.exr")) << arguments;
        EXPECT_EQ(IntOf(ReadImage(Path("out.exr")), "samplesPerPixel"), 2) << arguments;
        std::filesystem::remove(Path("out.exr"));
    }
    EXPECT_EQ(TextOf(Render("--LightSampler=power scene.pbrt"), "lightSampler"), "power");
    EXPECT_EQ(TextOf(Render("-light_sampler power scene.pbrt"), "lightSampler"), "power");
}

TEST_F(Flags, UnknownFlagsAndBadValuesAreErrors) {
    ExpectErrors({{"--spq 3 scene.pbrt", {"unknown flag --spq; did you mean --spp?", "--help"}},
                  {"-sppp=4 scene.pbrt", {"unknown flag -sppp; did you mean --spp?"}},
                  {"scene.pbrt --Light_Samplr bvh", {"did you mean --lightsampler?"}},
                  {"--frobnicate scene.pbrt", {"unknown flag --frobnicate\n"}},
                  {"--cropwindow 0.2 0.4 scene.pbrt",
                   {"--cropwindow takes 4 numbers, x0,x1,y0,y1: \"scene.pbrt\" is not a number"}},
                  {"scene.pbrt --cropwindow=0.2,0.4", {"takes 4 numbers, x0,x1,y0,y1, but has 2: 0.2 0.4"}},
                  {"--pixelbounds 1,2,3 scene.pbrt", {"--pixelbounds takes 4 numbers, x0,x1,y0,y1: \"scene.pbrt\""}},
                  {"--pixel 3 scene.pbrt", {"--pixel takes 2 numbers, x,y: \"scene.pbrt\""}},
                  {"scene.pbrt --pixel", {"--pixel takes 2 numbers, x,y, but has 0"}},
                  {"--spp 0 scene.pbrt", {"--spp", "--help"}},
                  {"--spp many scene.pbrt", {"--spp", "many"}},
                  {"--nthreads -1 scene.pbrt", {"--nthreads"}},
                  {"scene.pbrt --cropwindow 0,1,0", {"--cropwindow", "4"}},
                  {"--pixelbounds 0,1,0,x scene.pbrt", {"--pixelbounds", "x"}},
                  {"--render-coord-sys moon scene.pbrt", {"--render-coord-sys", "cameraworld"}},
                  {"--mse-reference-out mse.txt scene.pbrt", {"--mse-reference-image"}},
                  {"--integrator pahtt scene.pbrt", {"\"pahtt\"", "simplepath"}},
                  {"--cropwindow 0.5,0.5,0,1 scene.pbrt", {"command line: No pixel is left"}}});
}

TEST_F(Flags, FlagsOfStockHaveAHint) {
    std::vector<ErrorCase> cases;
    for (const auto &[flag, hint] : std::map<std::string, std::string>{{"--gpu", "CPU only"},
                                                                       {"--gpu-device 0", "CPU only"},
                                                                       {"--wavefront", "CPU only"},
                                                                       {"--interactive", "--serve"},
                                                                       {"--fullscreen", "--serve"},
                                                                       {"--log-level verbose", "--quiet"},
                                                                       {"--LogLevel=error", "--quiet"},
                                                                       {"--log-file log.txt", "--stats"},
                                                                       {"--log-utilization", "--stats"},
                                                                       {"--upgrade", "converts scene files"},
                                                                       {"--format", "converts scene files"},
                                                                       {"--toply", "converts scene files"},
                                                                       {"--pixelstats", "leave the flag out"},
                                                                       {"--debugstart 3", "leave the flag out"},
                                                                       {"--pixelmaterial 1,2", "leave the flag out"}})
        cases.push_back({flag + " scene.pbrt", {flag.substr(0, flag.find_first_of(" =")) + ": ", hint}});
    ExpectErrors(cases);
}

TEST_F(Flags, FloatsArePrintedAsGiven) {
    PBRT_SKIP_WITHOUT_EXT();
    for (const char *sampler : {"octree", "octree:model=paper", "oracle", "neepp", "spatial"}) {
        const std::string arguments = std::string("--spp 1 --stats=json --outfile out.exr --lightsampler ") + sampler;
        const Outcome o = Run(arguments + " scene.pbrt");
        ASSERT_EQ(o.status, 0) << o.err;
        const nlohmann::json stats = nlohmann::json::parse(o.out);
        const std::string parameters = stats.at("lightSampler").at("report").at("parameters");
        const ImageFile file = ReadImage(Path("out.exr"));
        EXPECT_EQ(TextOf(file, "lightSampler.parameters"), parameters);
        EXPECT_FALSE(std::regex_search(parameters, std::regex("[0-9]{8}"))) << parameters;
    }
    RunWell("--spp 1 --lightsampler octree:floor=0.01 --outfile out.exr scene.pbrt");
    EXPECT_TRUE(Has(TextOf(ReadImage(Path("out.exr")), "lightSampler.parameters"), "\"floor\":0.01,"));
}

TEST_F(Flags, HelpRendersNothing) {
    const std::vector<std::string> before = Files();
    const std::string help = Run("--help scene.pbrt").out;
    for (const char *flag : {"--help", "-h", "-help"}) {
        const Outcome o = Run(std::string(flag) + " scene.pbrt");
        EXPECT_EQ(o.status, 0);
        EXPECT_EQ(o.err, "");
        EXPECT_EQ(o.out, help);
    }
    EXPECT_EQ(Files(), before);
}

TEST_F(Flags, SamplesWithoutPixelsCannotBeAtTheirCentres) {
    const std::string said = "has no samples of single pixels";
    for (const char *integrator : {"mlt", "lightpath", "bdpt"}) {
        const std::string arguments =
            std::string("--spp 1 --disable-pixel-jitter scene.pbrt --integrator ") + integrator;
        EXPECT_EQ(Has(RunWell(arguments), said), std::string(integrator) != "bdpt") << integrator;
    }
    EXPECT_FALSE(Has(RunWell("--spp 1 --integrator mlt scene.pbrt"), said));
}

TEST_F(Flags, WindowsChooseTheDataWindow) {
    const ImageFile full = Render("scene.pbrt");
    EXPECT_EQ(full.image.Resolution(), Point2i(32, 24));
    struct Case {
        const char *arguments;
        Point2i low, high;
    };
    for (const Case &c : {Case{"--cropwindow 0.25,0.75,0.5,1", {8, 12}, {24, 24}},
                          Case{"--cropwindow 0.25 0.75 0.5 1", {8, 12}, {24, 24}},
                          Case{"--pixelbounds=3,9,5,8", {3, 5}, {9, 8}}, Case{"--pixel 7,11", {7, 11}, {8, 12}}}) {
        const ImageFile part = Render(std::string(c.arguments) + " scene.pbrt");
        ASSERT_TRUE(part.metadata.pixelBounds && part.metadata.fullResolution) << c.arguments;
        EXPECT_EQ(part.metadata.pixelBounds->low, c.low) << c.arguments;
        EXPECT_EQ(part.metadata.pixelBounds->high, c.high) << c.arguments;
        EXPECT_EQ(*part.metadata.fullResolution, Point2i(32, 24)) << c.arguments;
        ASSERT_EQ(part.image.Resolution(), c.high - c.low) << c.arguments;
        // The pixels of a part are the same as in the whole picture.
        EXPECT_TRUE(SamePixels(part, {full.image.Crop({c.low, c.high}), {}})) << c.arguments;
    }
}

TEST_F(Flags, QuickIsAQuarterOfTheResolutionAndOneSample) {
    for (const auto &[more, samples, said] :
         {std::tuple("", 1, "1 sample per pixel"), {"--spp 16 ", 16, "16 samples per pixel"}}) {
        const std::string messages = RunWell(std::string("--quick --outfile out.exr scene.pbrt ") + more);
        EXPECT_TRUE(Has(messages, std::string("--quick: 8 x 6 pixels, ") + said + ".")) << messages;
        EXPECT_TRUE(Has(messages, std::string("Wrote out.exr (") + said + ",")) << messages;
        const ImageFile quick = ReadImage(Path("out.exr"));
        EXPECT_EQ(quick.image.Resolution(), Point2i(8, 6));
        EXPECT_EQ(IntOf(quick, "samplesPerPixel"), samples);
    }
}

TEST_F(Flags, VersionIsOneLine) {
    const Outcome o = Run("--version");
    EXPECT_EQ(o.status, 0);
    EXPECT_EQ(o.err, "");
    EXPECT_TRUE(std::regex_match(o.out, std::regex(R"(pbrt_octree \d+\.\d+\.\d+ \(commit (\w+)(, modified)?\)\n)")))
        << o.out;
    EXPECT_EQ(TextOf(Render("--spp 1 scene.pbrt"), "pbrt.version") + "\n", o.out);
    EXPECT_EQ(std::count(o.out.begin(), o.out.end(), '\n'), 1);
}

TEST_F(Flags, ExamplesOfTheHelpRenderWithoutAWarning) {
    PBRT_SKIP_WITHOUT_EXT();
    std::istringstream help(Run("--help").out);
    int examples = 0;
    for (std::string line; std::getline(help, line);) {
        if (!line.starts_with("  pbrt ")) continue;
        const std::string command = line.substr(7, line.find("scene.pbrt") + 10 - 7);
        EXPECT_FALSE(Has(RunWell("--quick " + command), "Warning")) << command;
        ++examples;
    }
    EXPECT_GE(examples, 4);
}

TEST_F(Flags, PrintedPhasesAddUpToTheWallTime) {
    // Reading, building, preparing and writing take so long that a missing phase would be noticed.
    std::string text = SmallScene();
    text.replace(text.find("32"), 2, "900");
    text.replace(text.find("24"), 2, "900");
    for (int i = 0; i < 60000; ++i) text += "Shape \"disk\" \"float radius\" 0.0001\n";
    text +=
        "Shape \"loopsubdiv\" \"integer levels\" 8 \"integer indices\" [ 0 1 2 ] \"point3 P\" [ 9 9 9  9 9 8  9 8 9 ]\n";
    Write("heavy.pbrt", text);
    const bool ext = Has(LightSamplerListing(), "\noctree\n");
    const auto start = std::chrono::steady_clock::now();
    const Outcome o = Run(std::string("--stats --spp 1 --outfile out.exr --lightsampler ") + (ext ? "octree" : "bvh") +
                          " heavy.pbrt");
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_EQ(o.status, 0) << o.err;
    // The progress lines and the statistics use the same names; lines of sub-phases are indented.
    double lines = 0, statistics = 0;
    for (const std::string phase : {"start-up", "reading", "building", "preparing lights", "rendering", "writing"}) {
        static const std::regex kNumber("[0-9.]+");
        std::smatch number;
        const size_t at = o.out.find("\n  " + phase + " (s) ");
        ASSERT_NE(at, std::string::npos) << phase << "\n" << o.out;
        const std::string rest = o.out.substr(at + 7 + phase.size(), 60);
        ASSERT_TRUE(std::regex_search(rest, number, kNumber)) << phase;
        const double seconds = std::stod(number[0]);
        statistics += seconds;
        if (phase == "start-up") continue;
        const std::string done = "\n" + phase + ": done in ", text2 = "\n" + o.err;
        ASSERT_TRUE(Has(text2, done)) << phase << "\n" << o.err;
        const double line = std::stod(text2.substr(text2.find(done) + done.size()));
        EXPECT_NEAR(line, seconds, 0.02) << phase;
        lines += line;
    }
    EXPECT_GT(wall, 0.5) << "the run is too short to compare times";
    EXPECT_GT(statistics, 0.93 * wall - 0.1) << o.err << o.out;
    EXPECT_LT(statistics, 1.02 * wall + 0.05) << o.err << o.out;
    EXPECT_GT(lines, 0.9 * wall - 0.15) << o.err;
}

class Unsupported : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", R"(Camera "perspective"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16 "string filename" "fog.exr"
Integrator "function" "integer maxdepth" 2
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0 0 0 ]
MediumInterface "" "fog"
Camera "perspective"
WorldBegin
LightSource "infinite"
Texture "skin" "spectrum" "ptex" "string filename" "none.ptx"
Material "diffuse" "texture reflectance" "skin"
MediumInterface "fog" ""
Translate 0 0 3
Shape "sphere"
)");
    }
};

TEST_F(Unsupported, IsLeftOutLoudlyWhenAskedFor) {
    const std::string messages = RunWell("--spp 256 --ignore-unsupported scene.pbrt");
    for (const char *part : {"Warning: scene.pbrt:3:0: Integrator \"function\" is left out, volpath is used instead",
                             "Warning: scene.pbrt:9:0: Texture \"skin\"", "Wrote fog-incomplete.exr"})
        EXPECT_TRUE(Has(messages, part)) << part << "\n" << messages;
    const ImageFile file = ReadImage(Path("fog-incomplete.exr"));
    EXPECT_EQ(TextOf(file, "pbrt.integrator"), "volpath");
    EXPECT_EQ(IntOf(file, "pbrt.maxDepth"), 2);
    for (const char *part : {"scene.pbrt:3: Integrator \"function\"", "scene.pbrt:9: Texture \"skin\""})
        EXPECT_TRUE(Has(TextOf(file, "pbrt.ignored"), part)) << TextOf(file, "pbrt.ignored");
    EXPECT_NEAR(file.image.Get({8, 8}, 0), 0.5f, 0.03f) << "a sphere of reflectance 0.5 under a sky of 1";
    EXPECT_EQ(Files(), (std::vector<std::string>{"fog-incomplete.exr", "scene.pbrt"}));
}

TEST_F(Unsupported, NamesTheWayOut) {
    ExpectErrors({{"scene.pbrt", {"--integrator volpath", "ptex"}},
                  {"--ignore-media scene.pbrt", {"--integrator path", "ptex"}}});
}

TEST_F(Unsupported, MediaAloneCanBeLeftOut) {
    Write("fog.pbrt", SmallScene() + "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\n");
    RunWell("--spp 1 --ignore-media fog.pbrt");
    EXPECT_TRUE(Has(TextOf(ReadImage(Path("scene-without-media.exr")), "pbrt.ignored"), "MakeNamedMedium"));
    // An output name given by hand is not changed. A scene without unsupported parts gets no note that something was
    // left out.
    EXPECT_TRUE(Has(TextOf(Render("--spp 1 --ignore-media fog.pbrt"), "pbrt.ignored"), "MakeNamedMedium"));
    Write("plain.pbrt", SmallScene());
    RunWell("--spp 1 --ignore-unsupported plain.pbrt");
    EXPECT_FALSE(ReadImage(Path("scene.exr")).metadata.attributes.contains("pbrt.ignored"));
}

TEST_F(Flags, FilmFilenameIsUsedUnlessOutfileIsGiven) {
    RunWell("--spp 1 scene.pbrt");
    EXPECT_EQ(Files(), (std::vector<std::string>{"scene.exr", "scene.pbrt"}));
    std::filesystem::remove(Path("scene.exr"));
    RunWell("--spp 1 --outfile other.exr scene.pbrt");
    EXPECT_EQ(Files(), (std::vector<std::string>{"other.exr", "scene.pbrt"}));
}

TEST_F(Flags, OutfileExtensionChoosesTheFormat) {
    const ImageFile exr = Render("scene.pbrt");
    const ImageFile png = Render("scene.pbrt", "out.png");
    EXPECT_TRUE(Read("out.png").starts_with("\x89PNG"));
    EXPECT_EQ(png.image.Resolution(), Point2i(32, 24));
    const ImageFile pfm = Render("scene.pbrt", "out.pfm");
    EXPECT_TRUE(Read("out.pfm").starts_with("PF"));
    const Point2i middle(16, 12);
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(pfm.image.Get(middle, k), exr.image.Get(middle, k));
        EXPECT_NEAR(png.image.Get(middle, k), std::min(exr.image.Get(middle, k), Float(1)), 0.01f);
    }
}

TEST_F(Flags, SceneComesFromStandardInputOrSeveralFiles) {
    const std::string text = SmallScene();
    const size_t cut = text.find("Material");
    Write("first.pbrt", text.substr(0, cut));
    Write("second.pbrt", text.substr(cut));
    const ImageFile named = Render("scene.pbrt");
    for (const char *scene : {"< scene.pbrt", "- < scene.pbrt", "first.pbrt second.pbrt"})
        EXPECT_TRUE(SamePixels(Render(scene), named)) << scene;
}

TEST_F(Flags, QuietRunsPrintNothing) {
    const std::string warns = SmallScene() + "AttributeEnd\n";
    Write("warns.pbrt", warns);
    for (const char *scene : {"scene.pbrt", "warns.pbrt"}) {
        const Outcome o = Run(std::string("--quiet --spp 1 --outfile out.exr ") + scene);
        EXPECT_EQ(o.status, 0);
        EXPECT_EQ(o.out + o.err, "") << scene;
    }
    EXPECT_TRUE(Has(RunWell("--spp 1 --outfile out.exr warns.pbrt"), "Warning: warns.pbrt:15:"));
}

TEST_F(Flags, StatisticsAreOnStandardOutputWhenAskedFor) {
    EXPECT_EQ(Run("--spp 1 --outfile out.exr scene.pbrt").out, "");
    const Outcome o = Run("--spp 2 --stats --outfile out.exr scene.pbrt");
    EXPECT_EQ(o.status, 0);
    for (const char *part : {"Statistics", "camera paths", "closest-hit rays", "shadow rays", "light sampler", "bvh"})
        EXPECT_TRUE(Has(o.out, part)) << part << "\n" << o.out;
    EXPECT_TRUE(Has(o.out, std::to_string(32 * 24 * 2))) << "camera paths\n" << o.out;
}

TEST_F(Flags, StatisticsAsJsonAreAllOfStandardOutput) {
    const Outcome o = Run("--spp 2 --stats=json --nthreads 1 --outfile out.exr scene.pbrt");
    EXPECT_EQ(o.status, 0);
    const auto json = nlohmann::json::parse(o.out);
    EXPECT_EQ(json["schema"], 1);
    EXPECT_EQ(json["picture"], "out.exr");
    EXPECT_EQ(json["samplesPerPixel"], 2);
    EXPECT_EQ(json["threads"], 1);
    EXPECT_EQ(json["resolution"], (nlohmann::json{32, 24}));
    EXPECT_EQ(json["counts"]["cameraPaths"], 32 * 24 * 2);
    EXPECT_EQ(json["lightSampler"]["name"], "bvh");
    EXPECT_FALSE(json["isInterrupted"]);
    EXPECT_EQ(Run("--spp 1 --stats=text --outfile out.exr scene.pbrt").out.substr(0, 10), "Statistics");
    ExpectErrors({{"--stats=yaml scene.pbrt", {"--stats", "text", "json"}}});
}

TEST_F(Flags, MaxDepthAndIntegratorBeatTheScene) {
    const ImageFile direct = Render("--maxdepth 1 scene.pbrt");
    EXPECT_EQ(IntOf(direct, "pbrt.maxDepth"), 1);
    EXPECT_FALSE(SamePixels(direct, Render("scene.pbrt")));
    EXPECT_EQ(TextOf(Render("--integrator simplepath scene.pbrt"), "pbrt.integrator"), "simplepath");
}

}  // namespace pbrt::test
