// Pages in other people's pages: slides by reveal.js, a page that pandoc made of Markdown, a notebook's
// output cell.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "app/program.h"
#include "media/browser.h"
#include "needs.h"
#include "player/tab.h"

namespace obscura::app {
namespace {

const std::string kCradle = OBSCURA_SOURCE_DIR "/scenes/cradle.toml";

class Embedded : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    browser_ = media::browser();
    OBSCURA_NEEDS(browser_, "chromium-headless-shell");
    ASSERT_EQ(obscura("render " + kCradle + " -o run.html --to 0.5 --progress none").exit, 0);
  }

  void open(const std::string& file) {
    // a file's frames are of its own origin, as those of a site are
    tab_ = std::make_unique<Tab>(*browser_, folder_.string(), 1000, 700, "--allow-file-access-from-files");
    tab_->open("file://" + path(file));
  }

  /// What the player in the page's only frame answers.
  Browser::Json player(const std::string& does) {
    return tab_->value("document.querySelector('iframe').contentWindow.obscura.then((player) => { " + does +
                       " })");
  }

  /// Whether the page's only frame plays, without its lists, and as wide as it was asked to be.
  void plays(double width) {
    EXPECT_TRUE(bool(player("player.seek(0.3); player.draw(); return player.frame === 18;")));
    EXPECT_TRUE(bool(player(
        "return document.querySelector('iframe').contentDocument.body.classList.contains('embedded');")));
    EXPECT_NEAR(double(player("return document.querySelector('iframe').clientWidth;")), width, 2);
    EXPECT_GT(double(player("return player.picture.canvas.width;")), 0.7 * width);
    EXPECT_THAT(tab_->complaints("file://"), ::testing::IsEmpty());
  }

  std::optional<std::string> browser_;
  std::unique_ptr<Tab> tab_;
};

TEST_F(Embedded, InAMarkdownPage) {
  OBSCURA_NEEDS(installed("pandoc"), "pandoc");
  std::ofstream(path("page.md"))
      << "# A cradle\n\nHere it *swings*:\n\n"
         "<iframe src=\"run.html#embed\" width=\"800\" height=\"500\" title=\"A cradle\"></iframe>\n";
  ASSERT_EQ(shell("pandoc -s --metadata pagetitle=cradle page.md -o page.html").exit, 0);
  open("page.html");
  plays(800);
}

// As nbconvert writes the output of IPython.display.IFrame, and of HTML with the page itself in it, which is
// of no origin.
TEST_F(Embedded, InANotebooksOutputCell) {
  std::ofstream(path("notebook.html"))
      << "<!doctype html><html><head><meta charset=utf-8><title>notebook</title></head><body "
         "class=jp-Notebook>"
         "<div class=\"jp-OutputArea-child\"><div class=\"jp-RenderedHTMLCommon jp-RenderedHTML "
         "jp-OutputArea-output\">"
         "<iframe width=\"900\" height=\"560\" src=\"run.html#embed\" frameborder=\"0\" "
         "allowfullscreen></iframe>"
         "</div></div></body></html>";
  open("notebook.html");
  plays(900);
}

TEST_F(Embedded, InAFrameOfNoOrigin) {
  std::string page = contents(path("run.html")), quoted;
  for (const char c : page) quoted += c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  std::ofstream(path("cell.html"))
      << "<!doctype html><html><head><meta charset=utf-8><title>cell</title></head><body>"
         "<iframe sandbox=\"allow-scripts\" width=\"900\" height=\"560\" srcdoc=\""
      << quoted << "\"></iframe></body></html>";
  open("cell.html");
  EXPECT_EQ(tab_->value_in_frame("origin"), "null");
  EXPECT_EQ(double(tab_->value_in_frame(
                "obscura.then((player) => { player.seek(0.3); player.draw(); return player.frame; })")),
            18);
  EXPECT_GT(double(tab_->value_in_frame("obscura.then((player) => player.picture.canvas.width)")), 700);
  EXPECT_THAT(tab_->complaints("file://"), ::testing::IsEmpty());
}

TEST_F(Embedded, InASlide) {
  OBSCURA_LONG("npm", installed("npm"));
  const std::string npm = OBSCURA_BINARY_DIR "/npm";
  ASSERT_EQ(shell(OBSCURA_SOURCE_DIR "/tests/player/install " + npm).exit, 0);
  std::ofstream(path("slides.html"))
      << "<!doctype html><html><head><meta charset=utf-8><title>slides</title><link rel=stylesheet "
         "href=\"file://" +
             npm +
             "/node_modules/reveal.js/dist/reveal.css\"></head><body><div class=reveal><div class=slides>"
             "<section><h1>A cradle</h1></section><section><iframe data-src=\"run.html#embed\" width=\"800\" "
             "height=\"500\"></iframe></section></div></div><script src=\"file://" +
             npm +
             "/node_modules/reveal.js/dist/reveal.js\"></script>"
             "<script>window.ready = Reveal.initialize({ width: 1000, height: 700, margin: 0, "
             "preloadIframes: false });</script></body></html>";
  open("slides.html");
  tab_->value("ready.then(() => 1)");
  tab_->press("ArrowRight");
  tab_->value(
      "new Promise((done) => { const look = () => { const frame = document.querySelector('iframe'); if "
      "(frame.contentWindow && frame.contentWindow.obscura) return done(1); requestAnimationFrame(look); }; "
      "look(); })");
  plays(800);
  // keys pressed beside the frame are the slides'
  tab_->press("ArrowLeft");
  EXPECT_EQ(double(tab_->value("Reveal.getState().indexh")), 0);
}

}  // namespace
}  // namespace obscura::app
