#include "pbrt/core/state_file.h"

#include "support/errors.h"
#include "support/folder_test.h"

namespace pbrt::test {
namespace {

class StateFiles : public FolderTest {
  protected:
    /// A file with two sections.
    std::string Example(const std::string &name) const {
        StateWriter numbers, words;
        numbers(numbers_);
        words(std::string("one"));
        words.Value(7);
        WriteStateFile(Path(name), "test", {{"numbers", &numbers}, {"words", &words}});
        return Path(name);
    }
    std::vector<double> numbers_ = {1, 0.1, -1e300};
};

TEST_F(StateFiles, GiveBackWhatWasWritten) {
    const StateFile file(Example("a"), "test");
    std::vector<double> numbers;
    StateReader(file.Section("numbers"), "a")(numbers);
    EXPECT_EQ(numbers, numbers_);
    StateReader words(file.Section("words"), "a");
    EXPECT_EQ(words.Text(), "one");
    EXPECT_EQ(words.Value<int>(), 7);
    EXPECT_EQ(words.BytesLeft(), 0u);
    EXPECT_THROW(words.Value<char>(), UserError);
    ExpectError([&] { file.Section("more"); }, {"\"more\""});
    EXPECT_THROW(file.Section("numbers "), UserError);
    EXPECT_EQ(FileCount(), 1);
}

TEST_F(StateFiles, CutOffAtAnyByteTheyThrow) {
    const std::string whole = ReadFileContents(Example("a"));
    for (size_t size = 0; size < whole.size(); ++size) {
        const std::string path = Write("b", whole.substr(0, size));
        const std::string reason = MessageOf([&] { StateFile(path, "test"); });
        ExpectWords(reason, {path});
        EXPECT_TRUE(size <= 40 || reason.find("cut off") != std::string::npos) << reason;
    }
    ExpectError([&] { StateFile(Write("b", whole + "x"), "test"); }, {"damaged"});
}

TEST_F(StateFiles, WithAnyBitTurnedTheyThrow) {
    std::string content = ReadFileContents(Example("a"));
    for (size_t i = 0; i < content.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            content[i] = char(content[i] ^ (1 << bit));
            EXPECT_NE(MessageOf([&] { StateFile(Write("b", content), "test"); }), "") << i << " " << bit;
            content[i] = char(content[i] ^ (1 << bit));
        }
    EXPECT_EQ(MessageOf([&] { StateFile(Write("b", content), "test"); }), "");
}

TEST_F(StateFiles, OtherFilesThrowWithTheirName) {
    ExpectError([&] { StateFile(Path("none"), "test"); }, {"there is no such test"});
    ExpectError([&] { StateFile(Write("b", ""), "test"); }, {"is empty, not a test"});
    ExpectError([&] { StateFile(Write("b", "picture"), "test"); }, {"is not a test"});
    ExpectError([&] { StateFile(Example("a"), "checkpoint"); }, {"is a test, not a checkpoint"});
}

TEST_F(StateFiles, ANewOneThatCannotBeWrittenLeavesTheOldOne) {
    const std::string path = Example("a"), before = ReadFileContents(path);
    std::filesystem::permissions(path, std::filesystem::perms::owner_read);
    StateWriter nothing;
    EXPECT_THROW(WriteStateFile(path, "test", {{"nothing", &nothing}}), UserError);
    EXPECT_EQ(ReadFileContents(path), before);
    EXPECT_EQ(FileCount(), 1);
}

TEST(StateWriters, AVectorLongerThanTheFileThrows) {
    StateWriter writer;
    writer.Value(uint64_t{1} << 62);
    const std::string bytes = writer.Joined();
    StateReader reader(bytes, "a");
    std::vector<double> values;
    EXPECT_THROW(reader(values), UserError);
}

}  // namespace
}  // namespace pbrt::test
