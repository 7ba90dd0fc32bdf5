#include <nlohmann/json.hpp>
#include <regex>

#include "pbrt/core/progress.h"
#include "pbrt/films/render_file.h"
#include "program.h"

namespace pbrt::test {

class Flags : public SmallSceneProgram {};

TEST_F(Flags, SpellingOfNamesIsFree) {
    for (const char *arguments : {"--spp 2 --outfile out.exr", "-spp 2 -outfile out.exr", "--spp=2 --outfile=out.exr",
                                  "-SPP=2 --Out_File out.exr", "--s-p-p 2 -OUT-file=out.exr"}) {
        RunWell(std::string(arguments) + " scene.pbrt");
        EXPECT_EQ(IntOf(ReadImage(Path("out.exr")), "samplesPerPixel"), 2) << arguments;
        std::filesystem::remove(Path("out.exr"));
    }
}

TEST_F(Flags, UnknownFlagsAndBadValuesAreErrors) {
    ExpectErrors({{"--spq 3 scene.pbrt", {"unknown flag --spq; did you mean --spp?", "--help"}},
                  {"-sppp=4 scene.pbrt", {"unknown flag -sppp; did you mean --spp?"}},
                  {"scene.pbrt --Light_Samplr bvh", {"did you mean --lightsampler?"}},
                  {"--frobnicate scene.pbrt", {"unknown flag --frobnicate\n"}},
                  {"--cropwindow 0.2 0.4 scene.pbrt", {"--cropwindow", "4 numbers", "x0,x1,y0,y1", "\"scene.pbrt\""}},
                  {"scene.pbrt --cropwindow=0.2,0.4", {"--cropwindow", "4 numbers", "x0,x1,y0,y1", "2: 0.2 0.4"}},
                  {"--pixel 3 scene.pbrt", {"--pixel", "2 numbers", "x,y", "\"scene.pbrt\""}},
                  {"scene.pbrt --pixel", {"--pixel", "2 numbers", "x,y", "has 0"}},
                  {"scene.pbrt --pixel 2147483647,0", {"--pixel", "\"2147483647\" is not an integer from 0 to"}},
                  {"--pixel 3,4 --cropwindow 0,1,0,1 scene.pbrt", {"--cropwindow and --pixel exclude each other"}},
                  {"--pixel 3,4 --pixelbounds 0,9,0,9 scene.pbrt", {"--pixelbounds and --pixel exclude each other"}},
                  {"--pixel 40,3 scene.pbrt", {"line: ", "x 40 to 41", "y 3 to 4"}},
                  {"--spp 0 scene.pbrt", {"--spp", "--help"}},
                  {"--spp many scene.pbrt", {"--spp", "many"}},
                  {"--quick=maybe scene.pbrt", {"--quick", "maybe", "true nor false"}},
                  {"--nthreads -1 scene.pbrt", {"--nthreads"}},
                  {"--pixelbounds 0,1,0,x scene.pbrt", {"--pixelbounds", "4 numbers", "x0,x1,y0,y1", "\"x\""}},
                  {"--render-coord-sys moon scene.pbrt", {"--render-coord-sys", "cameraworld"}},
                  {"--mse-reference-out mse.txt scene.pbrt", {"--mse-reference-image"}},
                  {"--integrator pahtt scene.pbrt", {"Error: --integrator:1:0: ", "\"pahtt\"", "simplepath", "^"}},
                  {"--cropwindow 0.5,0.5,0,1 scene.pbrt", {"command line: No pixel is left"}}});
}

TEST_F(Flags, FlagsWithoutEffectAreErrors) {
    std::vector<ErrorCase> cases = {
        {"--checkpoint-interval 5 scene.pbrt", {"--checkpoint-interval needs --checkpoint"}},
    };
    using Words = std::vector<std::string>;
    for (const auto &[flag, integrator, valid] :
         {std::tuple("--maxdepth 2", "ambientocclusion", Words{"\"path\"", "\"sppm\""}),
          {"--shooting-sampler power", "path", {"\"bdpt\"", "\"lightpath\""}},
          {"--guide", "sppm", {"\"path\" and \"volpath\""}},
          {"--noise 0.1", "mlt", {"\"path\"", "\"bdpt\""}},
          {"--disable-pixel-jitter", "mlt", {"\"path\"", "\"sppm\""}}}) {
        const std::string name(flag);
        Words words = {name.substr(0, name.find(' ')), "no effect on integrator \"" + std::string(integrator) + "\""};
        words.insert(words.end(), valid.begin(), valid.end());
        cases.push_back({fmt::format("{} --integrator {} scene.pbrt", flag, integrator), words});
    }
    ExpectErrors(cases);
    RunWell("--resume=false --spp 1 --outfile out.exr scene.pbrt");
}

TEST_F(Flags, NumbersWithLeadingZerosAreDecimal) {
    RunWell("--spp 010 --seed -011 --pixel 07,010 --outfile out.exr scene.pbrt");
    const ImageFile file = ReadImage(Path("out.exr"));
    EXPECT_EQ(IntOf(file, "samplesPerPixel"), 10);
    EXPECT_EQ(IntOf(file, "pbrt.seed"), -11);
    EXPECT_EQ(file.metadata.pixelBounds, (Bounds2i{{7, 10}, {8, 11}}));
    RunWell("--spp 16 --samples 008:010 --checkpoint part.chk scene.pbrt");
    EXPECT_EQ(RenderFile(Path("part.chk")).Head().first, 8);
    EXPECT_EQ(RenderFile(Path("part.chk")).Head().end, 10);
}

TEST_F(Flags, NumbersAreFiniteAndTextsNotEmpty) {
    std::vector<ErrorCase> cases = {
        {"--outfile out.exr --outfile b.exr scene.pbrt", {"--outfile: is given more than once\n"}},
        {"--pixel 1,2 --pixel 3,4 scene.pbrt", {"--pixel: is given more than once\n"}},
        {"--aov albdo scene.pbrt", {"--aov: \"albdo\" is unknown; did you mean \"albedo\"? valid: "}},
        {"--render-coord-sys wrld scene.pbrt", {"\"wrld\" is unknown; did you mean \"world\"? valid: camera, "}},
        {"--seed 99999999999 scene.pbrt",
         {"--seed: \"99999999999\" is not an integer from -2147483648 to 2147483647\n"}},
        {"--pixelbounds 0,1,0,1e1 scene.pbrt", {"--pixelbounds: \"1e1\" is not an integer from"}}};
    for (const std::string value : {"1e3", "4.0", "1e400", "99999999999", "0", "many"})
        cases.push_back({"--spp " + value + " scene.pbrt",
                         {fmt::format("--spp: \"{}\" is not an integer from 1 to 2147483647\n", value)}});
    for (const std::string flag : {"--time", "--memory-limit", "--displacement-edge-scale", "--checkpoint-interval"})
        for (const std::string value : {"inf", "nan", "1e400", "0"})
            cases.push_back({flag + " " + value + " scene.pbrt",
                             {fmt::format("{}: \"{}\" is not a finite number above 0\n", flag, value)}});
    for (const std::string window : {"nan,1,0,1", "0,1e400,0,1", "0,1,0,-inf"})
        cases.push_back(
            {"--cropwindow " + window + " scene.pbrt", {"--cropwindow: \"", "\" is not a finite number\n"}});
    for (const std::string flag : {"--outfile", "--samples", "--lightsampler", "--integrator", "--checkpoint"})
        for (const auto &[value, message] :
             {std::pair(" ''", ": the value is empty\n"), {"=", ": the value after = is missing\n"}})
            cases.push_back({flag + value + " scene.pbrt", {flag + message}});
    cases.push_back({"--seed '' scene.pbrt", {"--seed: \"\" is not an integer"}});
    ExpectErrors(cases);
}

TEST_F(Flags, FlagsOfStockHaveAHint) {
    using Names = std::vector<std::string>;
    std::vector<ErrorCase> cases;
    for (const auto &[hint, flags] :
         {std::pair("CPU only", Names{"--gpu", "--gpu-device 0", "--wavefront"}),
          {"--serve", {"--interactive", "--fullscreen"}},
          {"--quiet prints errors only, --stats",
           {"--log-level verbose", "--LogLevel=error", "--log-file log.txt", "--log-utilization"}},
          {"converts scene files", {"--upgrade", "--format", "--toply"}},
          {"leave the flag out", {"--pixelstats", "--debugstart 3", "--pixelmaterial 1,2"}}})
        for (const std::string &flag : flags)
            cases.push_back({flag + " scene.pbrt", {flag.substr(0, flag.find_first_of(" =")) + ": ", hint}});
    ExpectErrors(cases);
}

TEST_F(Flags, FloatsArePrintedAsGiven) {
    PBRT_SKIP_WITHOUT_EXT();
    for (const char *sampler : {"octree", "octree:model=paper", "oracle", "neepp", "spatial"}) {
        const Outcome o =
            Run(fmt::format("--spp 1 --stats=json --outfile out.exr --lightsampler {} scene.pbrt", sampler));
        ASSERT_EQ(o.status, 0) << o.err;
        const std::string parameters = nlohmann::json::parse(o.out)["lightSampler"]["report"]["parameters"];
        EXPECT_EQ(TextOf(ReadImage(Path("out.exr")), "lightSampler.parameters"), parameters);
        EXPECT_FALSE(std::regex_search(parameters, std::regex("[0-9]{8}"))) << parameters;
    }
    const ImageFile file = Render("--spp 1 --lightsampler octree:floor=0.01 scene.pbrt");
    EXPECT_TRUE(Has(TextOf(file, "lightSampler.parameters"), "\"floor\":0.01,"));
}

TEST_F(Flags, HelpRendersNothing) {
    const std::vector<std::string> before = Files();
    const std::string help = Run("--help").out;
    for (const char *flag : {"--help", "-h", "-help"}) {
        const Outcome o = Run(std::string(flag) + " scene.pbrt");
        EXPECT_EQ(o.status, 0);
        EXPECT_EQ(o.err, "");
        EXPECT_EQ(o.out, help);
    }
    EXPECT_EQ(Files(), before);
}

TEST_F(Flags, SamplesWithoutPixelsCannotBeAtTheirCentres) {
    const std::string warning = "has no samples of single pixels";
    Write("centres.pbrt", "Option \"disablepixeljitter\" true\n" + SmallScene());
    for (const char *integrator : {"mlt", "lightpath", "bdpt"}) {
        const std::string messages = RunWell(std::string("--spp 1 centres.pbrt --integrator ") + integrator);
        EXPECT_EQ(Has(messages, warning), std::string(integrator) != "bdpt") << integrator;
    }
    EXPECT_FALSE(Has(RunWell("--spp 1 --integrator mlt scene.pbrt"), warning));
}

TEST_F(Flags, WindowsChooseTheDataWindow) {
    const ImageFile full = Render("scene.pbrt");
    EXPECT_EQ(full.image.Resolution(), Point2i(32, 24));
    for (const auto &[arguments, window] : {std::pair("--cropwindow 0.25,0.75,0.5,1", Bounds2i{{8, 12}, {24, 24}}),
                                            {"--cropwindow 0.25 0.75 0.5 1", {{8, 12}, {24, 24}}},
                                            {"--pixelbounds=3,9,5,8", {{3, 5}, {9, 8}}},
                                            {"--pixel 7,11", {{7, 11}, {8, 12}}}}) {
        SCOPED_TRACE(arguments);
        const ImageFile part = Render(std::string(arguments) + " scene.pbrt");
        EXPECT_EQ(part.metadata.pixelBounds, window);
        EXPECT_EQ(part.metadata.fullResolution, Point2i(32, 24));
        // The pixels of a part are the same as in the whole picture.
        EXPECT_TRUE(SamePixels(part, {full.image.Crop(window), {}}));
    }
}

TEST_F(Flags, QuickIsAQuarterOfTheResolutionAndOneSample) {
    for (const auto &[more, samples, printed] :
         {std::tuple("", 1, "1 sample per pixel"), {"--spp 16 ", 16, "16 samples per pixel"}}) {
        const std::string messages = RunWell(std::string("--quick --outfile out.exr scene.pbrt ") + more);
        ExpectWords(messages,
                    {fmt::format("--quick: 8 x 6 pixels, {}.", printed), fmt::format("Wrote out.exr ({},", printed)});
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
}

TEST_F(Flags, ExamplesOfTheHelpRenderWithoutAWarning) {
    const std::string help = Run("--help").out;
    static const std::regex kExample("\n  pbrt (.*scene\\.pbrt)");
    std::sregex_iterator example(help.begin(), help.end(), kExample);
    EXPECT_GE(std::distance(example, {}), HasExt() ? 5 : 3);
    for (; example != std::sregex_iterator(); ++example)
        EXPECT_FALSE(Has(RunWell("--quick " + example->str(1)), "Warning")) << example->str(1);
}

TEST_F(Flags, HelpNamesOnlySamplersOfThisBuild) {
    const std::string help = Run("--help").out + RunImgtool("splitn --help").out + Run("--list integrators").out;
    const auto names = [&](const std::string &word) {
        return std::regex_search(help, std::regex(fmt::format("\\b{}\\b", word)));
    };
    for (const char *name : {"octree", "spatial", "neepp", "oracle", "seen"})
        EXPECT_TRUE(Has(LightSamplerListing(), fmt::format("\n{}\n", name)) || !names(name)) << name;
    EXPECT_EQ(names("seen"), HasExt());
    EXPECT_TRUE(names("uniform"));
}

TEST_F(Flags, PrintedPhasesAddUpToTheWallTime) {
    // Reading, building, preparing and writing take so long that a missing phase would be noticed.
    std::string text = Replaced(Replaced(SmallScene(), "32", "900"), "24", "900");
    for (int i = 0; i < 60000; ++i) text += "Shape \"disk\" \"float radius\" 0.0001\n";
    text += Quoted(
        "Shape 'loopsubdiv' 'integer levels' 8 'integer indices' [ 0 1 2 ] 'point3 P' [ 9 9 9  9 9 8  9 8 9 ]\n");
    Write("heavy.pbrt", text);
    const auto start = std::chrono::steady_clock::now();
    const Outcome o =
        Run(fmt::format("--stats --spp 1 --outfile out.exr --lightsampler {} heavy.pbrt", HasExt() ? "octree" : "bvh"));
    const double wall = SecondsSince(start);
    ASSERT_EQ(o.status, 0) << o.err;
    // The progress lines and the statistics use the same names; lines of sub-phases are indented.
    const std::string messages = "\n" + o.err;
    double lines = 0, statistics = 0;
    for (const std::string phase : {"start-up", "reading", "building", "preparing lights", "rendering", "writing"}) {
        std::smatch printed, done;
        ASSERT_TRUE(std::regex_search(o.out, printed, std::regex("\n  " + phase + " \\(s\\) +([0-9.]+)"))) << o.out;
        statistics += std::stod(printed[1]);
        if (phase == "start-up") continue;
        ASSERT_TRUE(std::regex_search(messages, done, std::regex("\n" + phase + ": done in ([0-9.]+)"))) << messages;
        EXPECT_NEAR(std::stod(done[1]), std::stod(printed[1]), 0.02) << phase;
        lines += std::stod(done[1]);
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
        Write("scene.pbrt", SceneText()
                                .Camera("perspective")
                                .Film(16, 16, "'string filename' 'fog.exr'")
                                .Integrator("function", 2)
                                .Head("MakeNamedMedium 'fog' 'string type' 'homogeneous' 'rgb sigma_a' [ 0 0 0 ] "
                                      "'rgb sigma_s' [ 0 0 0 ]\nMediumInterface '' 'fog'")
                                .Camera("perspective")
                                .World(Objects()
                                           .Light("infinite")
                                           .Add("Texture 'skin' 'spectrum' 'ptex' 'string filename' 'none.ptx'")
                                           .Material("diffuse", "'texture reflectance' 'skin'")
                                           .Add("MediumInterface 'fog' ''\nTranslate 0 0 3")
                                           .Sphere()));
    }
};

TEST_F(Unsupported, IsLeftOutWithWarningsOnRequest) {
    ExpectWords(RunWell("--spp 256 --ignore-unsupported scene.pbrt"),
                {"Warning: scene.pbrt:3:0: Integrator \"function\"", "volpath",
                 "Warning: scene.pbrt:9:0: Texture \"skin\"", "Wrote fog-incomplete.exr"});
    const ImageFile file = ReadImage(Path("fog-incomplete.exr"));
    EXPECT_EQ(TextOf(file, "pbrt.integrator"), "volpath");
    EXPECT_EQ(IntOf(file, "pbrt.maxDepth"), 2);
    ExpectWords(TextOf(file, "pbrt.ignored"),
                {"scene.pbrt:3: Integrator \"function\"", "scene.pbrt:9: Texture \"skin\""});
    EXPECT_NEAR(file.image.Get({8, 8}, 0), 0.5f, 0.03f) << "a sphere of reflectance 0.5 under a sky of 1";
    EXPECT_EQ(Files(), (std::vector<std::string>{"fog-incomplete.exr", "scene.pbrt"}));
}

TEST_F(Unsupported, ErrorsNameTheFlagThatHelps) {
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
    Write("warns.pbrt", SmallScene() + "AttributeEnd\n");
    for (const char *scene : {"scene.pbrt", "warns.pbrt"}) {
        const Outcome o = Run(std::string("--quiet --spp 1 --outfile out.exr ") + scene);
        EXPECT_EQ(o.status, 0);
        EXPECT_EQ(o.out + o.err, "") << scene;
    }
    EXPECT_TRUE(Has(RunWell("--spp 1 --outfile out.exr warns.pbrt"), "Warning: warns.pbrt:15:"));
}

TEST_F(Flags, StatisticsAreOnStandardOutputOnRequest) {
    EXPECT_EQ(Run("--spp 1 --outfile out.exr scene.pbrt").out, "");
    const Outcome o = Run("--spp 2 --stats --outfile out.exr scene.pbrt");
    EXPECT_EQ(o.status, 0);
    ExpectWords(o.out,
                {"Statistics", "camera paths", "closest-hit rays", "shadow rays", "light sampler", "bvh", "1536"});
}

TEST_F(Flags, StatisticsAsJsonAreAllOfStandardOutput) {
    const auto json = nlohmann::json::parse(Run("--spp 2 --stats=json --nthreads 1 --outfile out.exr scene.pbrt").out);
    EXPECT_EQ(json["schema"], 1);
    EXPECT_EQ(json["picture"], "out.exr");
    EXPECT_EQ(json["samplesPerPixel"], 2);
    EXPECT_EQ(json["threads"], 1);
    EXPECT_EQ(json["resolution"], (nlohmann::json{32, 24}));
    EXPECT_EQ(json["counts"]["cameraPaths"], 32 * 24 * 2);
    EXPECT_EQ(json["lightSampler"]["name"], "bvh");
    EXPECT_FALSE(json["isInterrupted"]);
    const std::string part = Run("--spp 4 --samples 1:4 --checkpoint part --stats=json scene.pbrt").out;
    EXPECT_EQ(nlohmann::json::parse(part)["samplesPerPixel"], 3);
    EXPECT_EQ(Run("--spp 1 --stats=text --outfile out.exr scene.pbrt").out.substr(0, 10), "Statistics");
    ExpectErrors({{"--stats=yaml scene.pbrt", {"--stats", "text", "json"}}});
}

TEST_F(Flags, AFailureOfStandardOutputIsAnError) {
    launcher_ = R"(sh -c 'exec "$0" "$@" > /dev/full')";
    for (const char *arguments : {"--version", "--help", "--list all", "--spp 1 --stats --outfile out.exr scene.pbrt",
                                  "--spp 1 --stats=json --outfile out.exr scene.pbrt"}) {
        const Outcome o = Run(arguments);
        EXPECT_EQ(o.status, 1) << arguments;
        ExpectWords(o.err, {"Error:", "standard output"});
    }
    EXPECT_TRUE(Exists("out.exr"));
}

TEST_F(Flags, MaxDepthAndIntegratorBeatTheScene) {
    const ImageFile direct = Render("--maxdepth 1 scene.pbrt");
    EXPECT_EQ(IntOf(direct, "pbrt.maxDepth"), 1);
    EXPECT_FALSE(SamePixels(direct, Render("scene.pbrt")));
    EXPECT_EQ(TextOf(Render("--integrator simplepath scene.pbrt"), "pbrt.integrator"), "simplepath");
}

}  // namespace pbrt::test
