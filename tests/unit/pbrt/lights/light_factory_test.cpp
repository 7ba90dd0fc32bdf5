#include "light_test_support.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

template <class... Words>
void ExpectComplaint(const std::string &type, const ParamSet &params, int line, const Words &...words) {
    ExpectErrorAt([&] { Make(type, params); }, line, {words...});
}

TEST(LightFactory, UnknownLightListsTheValidOnes) {
    ExpectComplaint("spott", Params(), 100, "did you mean \"spot\"", "infinite");
    DiagnosticSink sink;
    ExpectErrorAt([&] { MakeAreaMaker(Params(), sink, "difuse"); }, 100, {"did you mean \"diffuse\""});
}

TEST(LightFactory, EmissionMustBeVisible) {
    ExpectComplaint("point", Params().Floats(ParamType::Spectrum, "I", {830, 0, 840, 1}), 1, "photometric units.");
    ExpectComplaint("point", Params().Floats(ParamType::Spectrum, "I", {588.2f, 0, 588.4f, 1, 588.6f, 0}), 1,
                    "lines narrower than 1 nm");
    EXPECT_TRUE(Make("point", Params().Floats(ParamType::Spectrum, "I", {588.8f, 0, 589, 1, 589.2f, 0})));
}

TEST(LightFactory, PortalsAreChecked) {
    auto corners = [](std::vector<Float> v) {
        return Params().Rgb("L", 1, 1, 1).Floats(ParamType::Point3, "portal", std::move(v));
    };
    ExpectComplaint("infinite", corners(std::vector<Float>(9, 0)), 2, "4 corners");
    ExpectComplaint("infinite", corners(std::vector<Float>(12, 0)), 2, "do not span");
    ExpectComplaint("infinite", corners({0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0}), 2, "do not span");
    ExpectComplaint("infinite", Params().Floats(ParamType::Point3, "portal", {0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0}), 1,
                    "needs");
    DiagnosticSink sink;
    for (bool good : {true, false}) {
        auto light =
            Make("infinite", corners({0, 0, 0, 0, 1, 0, 1, 1, good ? Float(0) : Float(0.5), 1, 0, 0}), {}, {}, sink);
        EXPECT_TRUE(light);
        EXPECT_EQ(sink.All().size(), good ? 0u : 1u);
        EXPECT_FALSE(sink.HasErrors());
    }
    ExpectWords(sink.All()[0].message, {"not a rectangle"});
}

TEST(LightFactory, ImagesOfLightsAreChecked) {
    ExpectComplaint("projection", Params().Number("fov", 40), 100, "filename");
    ExpectComplaint("projection", Params().String("filename", "/nowhere/slide.png"), 1, "slide.png");
    ExpectComplaint("projection", Params().String("filename", "/nowhere/slide.png").Number("fov", 180), 2, "fov");
    TemporaryImage wide("wide2.exr", RgbImage({4, 2}, [](int, int) { return Rgb(1); }));
    ExpectComplaint("goniometric", FileParams(wide), 1, "square");
    TemporaryImage black("black.exr", RgbImage({2, 2}, [](int, int) { return Rgb(0); }));
    for (const char *type : {"goniometric", "projection"}) {
        ExpectComplaint(type, FileParams(black).Number("power", 5), 2, "black");
        EXPECT_TRUE(Make(type, FileParams(black))) << "black light is legal";
    }
    TemporaryImage neither("neither.exr", Image(PixelFormat::Float, {2, 2}, {"Z"}));
    ExpectComplaint("goniometric", FileParams(neither), 1, "channel Y");
    ExpectComplaint("projection", FileParams(neither), 1, "R, G and B");
    const Params both = Params().Rgb("L", 1, 1, 1).String("filename", "x.exr");
    ExpectComplaint("infinite", both, 2, "exclude");
    ExpectErrorAt([&] { MakeAreaMaker(both); }, 2, {"exclude"});
}

TEST(LightFactory, WhatIsTooBrightForSinglePrecisionIsAnError) {
    for (const char *type : {"point", "spot", "distant", "goniometric", "infinite"}) {
        const std::string name = std::string(type) == "distant" || std::string(type) == "infinite" ? "L" : "I";
        ExpectComplaint(type, Params().Rgb(name, 1e25f, 1, 1).Number("scale", 1e30f), 2, "largest number");
        EXPECT_TRUE(Make(type, Params().Rgb(name, 1, 1, 1).Number("scale", 1e30f))) << type;
    }
    for (const char *type : {"point", "spot", "goniometric"})
        ExpectComplaint(type, Params().Number("scale", 1e30f).Number("power", 1e30f), 1, "largest number");
    for (const char *type : {"distant", "infinite"})
        ExpectComplaint(type, Params().Number("scale", 1e30f).Number("illuminance", 1e30f), 1, "largest number");
    const auto area = [] { MakeAreaMaker(Params().Rgb("L", 1e25f, 1, 1).Number("scale", 1e30f)); };
    ExpectErrorAt(area, 2, {"largest number"});
}

TEST(LightFactory, EnvironmentMustBeSquareFiniteRgb) {
    ExpectComplaint("infinite", Params().String("filename", "/nowhere/sky.exr"), 1, "sky.exr");
    TemporaryImage wide("wide.exr", RgbImage({4, 2}, [](int, int) { return Rgb(1); }));
    ExpectComplaint("infinite", FileParams(wide), 1, "square");
    TemporaryImage holes("holes.exr", RgbImage({2, 2}, [](int x, int) { return x ? Rgb(Infinity) : Rgb(1); }));
    ExpectComplaint("infinite", FileParams(holes), 1, "infinite");
    TemporaryImage mono("mono.exr", Image(PixelFormat::Float, {2, 2}, {"Y"}));
    ExpectComplaint("infinite", FileParams(mono), 1, "R, G and B");
}

TEST(LightFactory, NothingEmitsLessThanNothing) {
    for (const auto &[type, name] : {std::pair("point", "I"), {"infinite", "L"}}) {
        ExpectComplaint(type, Params().Number("scale", -1), 1, "at least 0");
        ExpectComplaint(type, Params().Floats(ParamType::Spectrum, name, {400, -1, 700, 1}), 1, "400 nm is -1");
    }
}

TEST(LightFactory, DirectionsAndConesAreChecked) {
    ExpectComplaint("distant", Params().Point("from", {0, 0, 1}), 1, "same point");
    ExpectComplaint("spot", Params().Point("from", {1, 2, 3}).Point("to", {1, 2, 3}), 2, "same point");
    ExpectComplaint("spot", Params().Number("coneangle", 0), 1, "coneangle");
    for (Float edge : {-1.f, 61.f}) ExpectComplaint("spot", Cone(30, edge), 2, "conedeltaangle");
}

TEST(LightFactory, EveryParameterOfALightIsRead) {
    TemporaryImage image("read.exr", RgbImage({4, 4}, [](int, int) { return Rgb(1); }));
    const auto ones = [](std::initializer_list<const char *> names) {
        Params params;
        for (const char *name : names) params.Number(name, 1);
        return params;
    };
    const std::vector<Float> portal = {0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0};
    const std::pair<const char *, Params> rows[] = {
        {"point", ones({"scale", "power"}).Rgb("I", 1, 1, 1).Point("from", Point3(0))},
        {"spot", ones({"scale", "power", "coneangle", "conedeltaangle"})
                     .Rgb("I", 1, 1, 1)
                     .Point("from", Point3(0))
                     .Point("to", {1, 0, 0})},
        {"distant", ones({"scale", "illuminance"}).Rgb("L", 1, 1, 1).Point("from", Point3(0)).Point("to", {1, 0, 0})},
        {"infinite", ones({"scale", "illuminance"}).Rgb("L", 1, 1, 1)},
        {"infinite",
         ones({"scale", "illuminance"}).String("filename", image.Path()).Floats(ParamType::Point3, "portal", portal)},
        {"goniometric", ones({"scale", "power"}).Rgb("I", 1, 1, 1).String("filename", image.Path())},
        {"projection", ones({"fov", "scale", "power"}).String("filename", image.Path())},
    };
    DiagnosticSink sink;
    for (const auto &[type, params] : rows) EXPECT_TRUE(Make(type, params, {}, {}, sink)) << type;
    MakeAreaMaker(ones({"scale", "power"}).Rgb("L", 1, 1, 1).Bool("twosided", true), sink);
    EXPECT_FALSE(sink.HasErrors()) << sink.All().front().message;
}

TEST(InternSpectrum, EqualEmissionIsOneObject) {
    RgbIlluminantSpectrum a(ColorSpace::SRGB(), {1, 0.5f, 0.2f}), same(ColorSpace::SRGB(), {1, 0.5f, 0.2f}),
        other(ColorSpace::SRGB(), {1, 0.5f, 0.3f});
    auto first = InternSpectrum(a);
    EXPECT_EQ(first, InternSpectrum(same));
    EXPECT_NE(first, InternSpectrum(other));
    EXPECT_NEAR((*first)(550), a(550), 1e-6);
}

}  // namespace
}  // namespace pbrt::test
