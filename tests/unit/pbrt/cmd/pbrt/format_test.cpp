// Compares docs/reference/compatibility.md with the program: an unknown parameter makes the program list all valid
// ones.
#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "program.h"

namespace pbrt::test {

namespace {

using Names = std::set<std::string>;

std::string Document(const std::string &name = "compatibility") {
    std::ifstream in(PBRT_SOURCE_DIR "/docs/reference/" + name + ".md");
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The first group of every match.
std::vector<std::string> Matches(const std::string &text, const std::string &expression) {
    const std::regex regex(expression);
    return {std::sregex_token_iterator(text.begin(), text.end(), regex, 1), {}};
}

/// The texts between backticks.
std::vector<std::string> QuotedWords(const std::string &text) { return Matches(text, "`([^`]+)`"); }

/// The parameter names, without types, from the table rows whose first cell has entities such as `Shape "sphere"`.
/// Float and spectrum textures are not distinguished: `Texture "..." "float" "mix"` is Texture "mix".
std::map<std::string, Names> DocumentedParameters() {
    std::map<std::string, Names> out;
    std::istringstream lines(Document());
    for (std::string line; std::getline(lines, line);) {
        static const std::regex kRow(R"(\| (.*?) \| (.*?) ?\|.*)");
        std::smatch cells;
        if (!std::regex_match(line, cells, kRow)) continue;
        Names names;
        for (const std::string &p : QuotedWords(cells[2])) names.insert(p.substr(p.rfind(' ') + 1));
        for (const std::string &entity : QuotedWords(cells[1]))
            if (entity.ends_with('"'))
                out[entity.substr(0, entity.find(' ')) + entity.substr(entity.rfind(' '))].insert(names.begin(),
                                                                                                  names.end());
    }
    return out;
}

/// Required parameters: without them the entity is not built far enough to report unknown ones.
std::string Needed(const std::string &entity) {
    static const std::string assets = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/",
                             file = "'string filename' '" + assets;
    static const std::map<std::string, std::string> kNeeded = {
        {"Camera \"realistic\"", "'string lensfile' '" + assets + "lens_symmetric.dat'"},
        {"Shape \"trianglemesh\"", "'point3 P' [ 0 0 0 1 0 0 0 1 0 ]"},
        {"Shape \"loopsubdiv\"", "'point3 P' [ 0 0 0 1 0 0 0 1 0 ] 'integer indices' [ 0 1 2 ]"},
        {"Shape \"bilinearmesh\"", "'point3 P' [ 0 0 0 1 0 0 0 1 0 1 1 0 ]"},
        {"Shape \"curve\"", "'point3 P' [ 0 0 0 1 0 0 0 1 0 1 1 0 ]"},
        {"Shape \"plymesh\"", file + "vase_ascii.ply'"},
        {"Material \"subsurface\"", "'rgb reflectance' [ 0.5 0.5 0.5 ]"},
        {"Material \"mix\"", "'string materials' [ 'a' 'a' ]"},
        {"Medium \"uniformgrid\"", "'float density' 1"},
        {"Medium \"rgbgrid\"", "'rgb sigma_a' [ 1 1 1 ]"},
        {"Medium \"nanovdb\"", file + "blob.nvdb'"},
        {"Texture \"imagemap\"", file + "card_srgb8.png'"},
        {"LightSource \"projection\"", file + "slide.png'"}};
    auto it = kNeeded.find(entity);
    return it == kNeeded.end() ? "" : Quoted(it->second);
}

std::map<std::string, Names> ParametersThatErrorsList(const std::string &messages) {
    static const std::regex kError(R"rx("float nosuch": unused parameter of (\w+ "\w*")[^\n]*valid: ([^\n]*)\.\n)rx");
    std::map<std::string, Names> out;
    for (std::sregex_iterator i(messages.begin(), messages.end(), kError), end; i != end; ++i) {
        for (const std::string &name : Matches((*i)[2], "([^, ]+)")) out[(*i)[1]].insert(name);
    }
    return out;
}

}  // namespace

class Format : public Program {
  protected:
    std::map<std::string, Names> Listed() const {
        std::string world = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n";
        std::map<std::string, Names> out;
        for (const auto &[entity, names] : DocumentedParameters()) {
            const size_t blank = entity.find(' ');
            const std::string directive = entity.substr(0, blank), type = entity.substr(blank);
            const std::string parameters = Needed(entity) + " \"float nosuch\" 1\n";
            if (directive == "Texture") {
                const bool isFloat = type == " \"fbm\"" || type == " \"wrinkled\"" || type == " \"windy\"";
                const std::string rest = (isFloat ? " \"float\"" : " \"spectrum\"") + type + ' ';
                world += "Texture \"a" + type.substr(2) + rest + parameters;
                if (names.contains("mapping"))
                    world += "Texture \"b" + type.substr(2) + rest + "\"string mapping\" \"planar\" " + parameters;
            } else if (directive == "Medium") {
                world += "MakeNamedMedium" + type + " \"string type\"" + type + ' ' + parameters;
            } else if (directive == "Shape" || directive == "Material" || directive == "LightSource") {
                world += entity + ' ' + parameters;
            } else if (directive == "AreaLightSource") {
                world += entity + ' ' + parameters + "Shape \"disk\"\n";
            } else {  // only the last entity of this kind counts, so each gets its own scene
                Write("one.pbrt", SceneText().Head(entity + ' ' + parameters).World());
                out.merge(ParametersThatErrorsList(Run("--quiet --outfile out.exr one.pbrt").err));
            }
        }
        Write("world.pbrt", SceneText().World(world));
        out.merge(ParametersThatErrorsList(Run("--quiet --outfile out.exr world.pbrt").err));
        return out;
    }
};

TEST_F(Format, ParametersAreThoseOfTheDocument) {
    PBRT_SKIP_WITHOUT_EXT();
    std::map<std::string, Names> listed = Listed();
    size_t compared = 0;
    for (const auto &[entity, documented] : DocumentedParameters()) {
        // This material needs a file of tables.
        if (entity == "Material \"measured\"") continue;
        const Names &known = listed[entity.starts_with("Medium ") ? "MakeNamed" + entity : entity];
        for (const std::string &name : known)
            EXPECT_TRUE(documented.contains(name) || name.find('.') != std::string::npos)
                << entity << " has \"" << name << "\", which docs/reference/compatibility.md does not list";
        for (const std::string &name : documented) {
            ++compared;
            EXPECT_TRUE(known.contains(name))
                << entity << " has no \"" << name << "\", although docs/reference/compatibility.md lists it";
        }
    }
    EXPECT_GT(compared, 200u);
}

/// The generated parts of the pages are what the program prints.
TEST_F(Format, PagesAreWhatTheProgramLists) {
    PBRT_SKIP_WITHOUT_EXT();  // which adds parameters of direction sampling
    const std::string begin = "<!-- pbrt --list table -->\n", document = Document();
    const size_t from = document.find(begin), to = document.find("<!-- end -->");
    ASSERT_TRUE(from != std::string::npos && to != std::string::npos);
    EXPECT_EQ(document.substr(from + begin.size(), to - from - begin.size()), Run("--list table").out)
        << "put the output of `pbrt --list table` between the marks of docs/reference/compatibility.md";
    EXPECT_EQ(Document("parameters"), Run("--list all").out)
        << "write the output of `pbrt --list all` to docs/reference/parameters.md";
}

TEST_F(Format, OneFamilyIsListedAndAnUnknownOneIsAnError) {
    EXPECT_TRUE(Has(Run("--list cameras").out, "float fov = 90 (above 0, below 180 degrees)\n        "));
    // The listing begins with a line break.
    EXPECT_EQ(Run("--list lightsamplers").out, LightSamplerListing().substr(1));
    ExpectErrors({{"--list camera", {"did you mean \"cameras\"?"}}});
}

TEST_F(Format, FlagsAreThoseOfTheDocument) {
    const std::string document = Document();
    const size_t begin = document.find("\n## pbrt\n"), end = document.find("\n## ", begin + 1);
    ASSERT_NE(end, std::string::npos);
    Names documented, known;
    for (const std::string &flag : QuotedWords(document.substr(begin, end - begin)))
        if (flag.starts_with("--") && flag.find_first_of(" =") == std::string::npos) documented.insert(flag);
    for (const std::string &flag : Matches(Run("--help").out, R"(\n  (?:-\w,)?(--[a-z-]+))")) known.insert(flag);
    EXPECT_GT(known.size(), 25u);
    EXPECT_EQ(documented, known);
}

}  // namespace pbrt::test
