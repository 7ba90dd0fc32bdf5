#include <cmath>

#include "imgtool_program.h"
#include "pbrt/cmd/imgtool/preetham_sky.h"
#include "pbrt/math/warps.h"

namespace pbrt {

using imgtool::PreethamSky;

namespace {

double Lux(const Xyz &irradiance) { return double(irradiance.y) * PreethamSky::CandelasPerY; }
double SunSolidAngle() { return 2 * double(Pi) * (1 - std::cos(PreethamSky::SunRadius)); }
double SunLux(const PreethamSky &sky) { return Lux(sky.SunRadiance()) * SunSolidAngle(); }

}  // namespace

TEST(PreethamSky, ZenithIsThatOfThePaper) {
    const PreethamSky sky(45, 3, 0);
    const Xyz zenith = sky.Radiance({0, 0, 1});
    // Appendix A.2, computed by hand: (4.0453 * 3 - 4.9710) tan((4/9 - 3/120) 90 deg) - 0.2155 * 3 + 2.4192 kcd/m^2.
    EXPECT_NEAR(double(zenith.y) * PreethamSky::CandelasPerY, 7321, 3);
    const Float sum = zenith.x + zenith.y + zenith.z;
    EXPECT_NEAR(zenith.x / sum, 0.2457f, 5e-4f);
    EXPECT_NEAR(zenith.y / sum, 0.2515f, 5e-4f);
}

TEST(PreethamSky, SunAndSkyAreAsBrightAsMeasuredOnClearDays) {
    const PreethamSky noon(60, 2.5, 0.2), evening(5, 2.5, 0.2);
    EXPECT_GT(SunLux(noon), 70000);
    EXPECT_LT(SunLux(noon), 115000);
    EXPECT_GT(Lux(noon.SkyIrradiance()), 8000);
    EXPECT_LT(Lux(noon.SkyIrradiance()), 32000);  // the model gives rather bright skies
    EXPECT_LT(SunLux(evening), 0.4 * SunLux(noon));
    EXPECT_LT(SunLux(PreethamSky(60, 8, 0.2)), SunLux(noon));
    // The low sun is redder than the high one, and the sky opposite is bluer than either.
    auto redness = [](const Xyz &v) { return v.x / v.z; };
    EXPECT_GT(redness(evening.SunRadiance()), 1.5f * redness(noon.SunRadiance()));
    EXPECT_LT(redness(noon.Radiance(Normalize(Vector3(0, -1, 1)))), 0.9f * redness(noon.SunRadiance()));
}

TEST(PreethamSky, IsBrightestAroundTheSunAndBlackBelowTheHorizon) {
    const PreethamSky sky(30, 3, 0.5);
    const Float around = sky.Radiance(sky.SunDirection()).y;
    for (Vector3 w : {Vector3(0, 0, 1), Vector3(1, 0, 1), Vector3(0, -1, 1), Vector3(1, 1, 0.2f)})
        EXPECT_LT(sky.Radiance(Normalize(w)).y, around);
    EXPECT_EQ(sky.Radiance({0, 1, 0}), Xyz(0));
    EXPECT_EQ(sky.Radiance({0, 0, -1}), Xyz(0));
    EXPECT_FLOAT_EQ(sky.SunDirection().z, 0.5f);
}

TEST(PreethamSky, BrightGroundBrightensTheSkyEvenly) {
    const PreethamSky dark(40, 3, 0), bright(40, 3, 0.8);
    const Float zenith = bright.Radiance({0, 0, 1}).y - dark.Radiance({0, 0, 1}).y;
    const Vector3 low = Normalize(Vector3(1, -1, 0.3f));
    EXPECT_GT(zenith, 0);
    EXPECT_NEAR(bright.Radiance(low).y - dark.Radiance(low).y, zenith, 1e-3f * zenith);
    // The ground sends 0.8 of the daylight up, and the sky of this turbidity returns some 9 % of that.
    const double all = Lux(dark.SkyIrradiance()) + SunLux(dark) * 0.6428;
    EXPECT_NEAR((Lux(bright.SkyIrradiance()) - Lux(dark.SkyIrradiance())) / all, 0.8 * 0.09, 0.03);
}

TEST_F(Imgtool, MakeskyHoldsTheModelAndAllOfTheSun) {
    const PreethamSky sky(20, 4, 0.3);
    const ColorSpace &aces = *ColorSpace::Find("aces2065-1");
    for (int size : {64, 512}) {
        const ImageFile file = Written("makesky --elevation 20 --turbidity 4 --albedo 0.3 --resolution " +
                                       std::to_string(size) + " --outfile sky.exr");
        EXPECT_EQ(file.metadata.colorSpace, &aces);
        ASSERT_EQ(file.image.Resolution(), Point2i(size));
        double light = 0;
        ForEachPixel(file.image, [&](Point2i p) {
            const Vector3 w = EqualAreaSquareToSphere((Point2(p) + Point2(0.5f)) / Float(size));
            const Rgb rgb = RgbAt(file.image, p), expected = aces.ToRgb(sky.Radiance(w));
            if (AngleBetween(w, sky.SunDirection()) < 0.15f) light += double((aces.ToXyz(rgb) - sky.Radiance(w)).y);
            else
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(rgb[c], expected[c], 1e-3f * expected[c] + 1e-6f);
        });
        EXPECT_NEAR(light * 4 * double(Pi) / (size * size) / SunSolidAngle() / double(sky.SunRadiance().y), 1, 0.01);
    }
    ExpectErrors({{"makesky", "--outfile"},
                  {"makesky --outfile s.exr --elevation 91", "elevation"},
                  {"makesky --outfile s.exr --turbidity 1", "turbidity"},
                  {"makesky --outfile s.exr --albedo 2", "albedo"}});
}

}  // namespace pbrt
