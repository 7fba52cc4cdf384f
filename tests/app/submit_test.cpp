#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "app/console/scripts.h"
#include "where.h"
#include "with_slurm.h"

namespace obscura::app {
namespace {

const std::string kSmallFilm = " --set film.size=[160,90] --set film.fps=10";

using Submit = Program;

TEST_F(Submit, DryRunShowsScriptsThatAShellReadsAndNeedsNoSlurm) {
  scene(kRoom, "a room.toml");
  const Outcome run = shell("PATH=/nowhere " OBSCURA_BINARY
                            " submit 'a room.toml' --tasks 4 --at-once 2 -o \"it's.mp4\" --dry-run "
                            "--set ball.mass=2 -- -p long --time=1:00:00");
  ASSERT_EQ(run.exit, 0) << run.err;
  for (const char* part :
       {"#SBATCH -p long\n", "#SBATCH --time=1:00:00\n", "#SBATCH --requeue\n", "--array=1-4%2",
        "--prepare 4", "--shard \"$shard/4\"", " join 'it'\\''s.mp4' &", "'a room.toml'",
        "--dependency=afterok:$shards --kill-on-invalid-dep=yes", "it's.mp4.slurm/shards.sbatch\n"})
    EXPECT_NE(run.out.find(part), std::string::npos) << part << "\n" << run.out;
  std::ofstream(path("all.sh")) << run.out;
  EXPECT_EQ(shell("sh -n all.sh").exit, 0) << contents(path("all.sh"));
  EXPECT_FALSE(std::filesystem::exists(path("it's.mp4.slurm")));
}

TEST_F(Submit, HandsOnWhatHoldsForEveryTask) {
  scene(kRoom);
  // each command of the scripts, without the comments
  const auto commands = [&](const std::string& arguments) {
    const Outcome run = obscura("submit scene.toml --tasks 2 --dry-run " + arguments);
    EXPECT_EQ(run.exit, 0) << run.err;
    std::vector<std::string> found;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);)
      if (line.find("obscura") != line.npos && line.ends_with(" &")) found.push_back(line);
    return found;
  };
  const auto film = commands("-o a.mp4 --memory-limit '1.5 GiB' --backend osmesa --native");
  ASSERT_EQ(film.size(), 3u);
  for (const std::string& line : film) {
    EXPECT_THAT(line, testing::HasSubstr(" --memory-limit '1.5 GiB'"));
    // what joins them draws nothing
    for (const char* flag : {" --backend osmesa", " --native"})
      EXPECT_EQ(line.find(flag) != line.npos, line.find(" join ") == line.npos) << line;
  }
  const auto sweep = commands("-o a.csv --vary seed=1:4 --measure hash@end --memory-limit 2GB");
  ASSERT_GE(sweep.size(), 1u);
  EXPECT_THAT(sweep[0], testing::HasSubstr(" --memory-limit 2GB"));
  for (const std::string& line : commands("-o a.mp4"))
    for (const char* flag : {"--memory-limit", "--backend", "--native"})
      EXPECT_EQ(line.find(flag), line.npos) << line;
  // a table is not drawn
  for (const char* flag : {"--backend egl", "--native"}) {
    const Outcome run = obscura(
        std::string("submit scene.toml --tasks 2 --dry-run -o a.csv --vary seed=1:4 --measure hash@end ") +
        flag);
    EXPECT_EQ(run.exit, 2);
    EXPECT_THAT(run.err, testing::HasSubstr("a sweep's table draws nothing"));
  }
  EXPECT_EQ(obscura("submit scene.toml --tasks 2 --dry-run --memory-limit many").exit, 2);
}

TEST_F(Submit, RefusesWhatCannotBeSharedOut) {
  scene(kRoom);
  EXPECT_EQ(obscura("submit scene.toml --tasks 4 --dry-run -o -").exit, 2);
  EXPECT_EQ(obscura("submit - --tasks 4 --dry-run <scene.toml").exit, 2);
  EXPECT_EQ(obscura("submit scene.toml --tasks 4 --dry-run --measure hash@end -o a.mp4").exit, 2);
  const Outcome none = shell("PATH=/nowhere " OBSCURA_BINARY " submit scene.toml --tasks 4");
  EXPECT_EQ(none.exit, 4);
  EXPECT_NE(none.err.find("no Slurm"), std::string::npos) << none.err;
}

TEST_F(Submit, TellsWhatIsWrongWithASweepBeforeItAsksSlurm) {
  scene(kRoom);
  const std::string submit = "submit scene.toml --tasks 4 -o a.csv ";
  for (const auto& [flags, told] : {std::pair{"--measure nobody.position.x@1", "nobody"},
                                    {"--measure hash", "hash"},
                                    {"--vary seed=1:3", "--measure says what is measured in each run"},
                                    {"--vary nobody.mass=1,2 --measure hash@end", "nobody"},
                                    {"--vary seed=3:1 --measure hash@end", "runs backwards"},
                                    {"--vary seed=1:3 --measure hash@end,hash@end", "two columns"}}) {
    for (const char* how : {"--dry-run", "--no-wait"}) {
      const Outcome run = shell("PATH=/usr/bin:/bin; " OBSCURA_BINARY " " + submit + how + " " + flags);
      EXPECT_THAT(run.exit, testing::AnyOf(2, 3)) << flags;
      EXPECT_THAT(run.err, testing::HasSubstr(told)) << flags;
      EXPECT_EQ(run.out, "");
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path("a.csv.slurm")));
}

TEST_F(Submit, RefusesOptionsOfSbatchThatItNeedsItself) {
  scene(kRoom);
  const std::string submit = "submit scene.toml --tasks 4 --dry-run -- ";
  for (const auto& [option, name] : {std::pair{"--array=1-3", "--array"},
                                     {"-a 1-3", "--array"},
                                     {"-a1-3", "--array"},
                                     {"--arr=1", "--array"},
                                     {"-p debug --dependency=afterok:1", "--dependency"},
                                     {"--dep afterok:1", "--dependency"},
                                     {"-d afterok:1", "--dependency"},
                                     {"-Ho out", "--output"},
                                     {"--output=a.log", "--output"},
                                     {"-e err", "--error"},
                                     {"-D /tmp", "--chdir"},
                                     {"--chdir /tmp", "--chdir"},
                                     {"--wrap=true", "--wrap"},
                                     {"-W", "--wait"},
                                     {"--signal=B:USR1", "--signal"},
                                     {"--no-requeue", "--no-requeue"},
                                     {"--parsable", "--parsable"},
                                     {"--test-only", "--test-only"},
                                     {"--open-mode=truncate", "--open-mode"}}) {
    const Outcome run = obscura(submit + option);
    EXPECT_EQ(run.exit, 2) << option;
    EXPECT_THAT(run.err, testing::HasSubstr(std::string(name) + " cannot be given: submit sets it itself"))
        << option << run.err;
  }
  for (const char* option :
       {"-p debug", "-pdebug", "--partition=a", "--hold", "-H", "--exclude=a", "--export=ALL",
        "--wait-all-nodes=1", "-J name", "-HJd", "--mem=4G", "-t 1:00", "--requeue", "-c 2"}) {
    const Outcome run = obscura(submit + option);
    EXPECT_EQ(run.exit, 0) << option << run.err;
  }
}

TEST_F(Submit, WritesNoCommandsThatANameBringsAlong) {
  scene(kRoom);
  for (const char* arguments :
       {"-o \"$(printf 'a\\ntouch evil\\n.mp4')\"", "-- \"$(printf -- '--comment=a\\ntouch evil')\""}) {
    const Outcome run = obscura(std::string("submit scene.toml --tasks 4 --dry-run ") + arguments);
    EXPECT_EQ(run.exit, 2) << run.out;
    EXPECT_THAT(run.err, testing::HasSubstr("has a control character"));
  }
}

// SIGTERM goes to all of a job, and may come late: to what asks Slurm whether the job is to queue again.
// While one is on its way Slurm has another word for a job that runs.
class ToldToStop : public Submit, public testing::WithParamInterface<const char*> {};

TEST_P(ToldToStop, AScriptQueuesAgainUnlessItsJobWasCancelled) {
  const std::string state = GetParam();
  Errand errand;
  errand.made = "room.mp4", errand.folder = ".", errand.where = path("");
  errand.prepare = "sh -c 'trap \"exit 130\" TERM; touch ready; while :; do sleep 0.02; done'";
  std::ofstream(path("job.sh")) << prepare_script(errand);
  std::ofstream(path("scontrol")) << "#!/bin/sh\n"
                                     "if [ $1 = requeue ]; then touch requeued; exit 1; fi\n"
                                     "touch shown; while [ ! -e go ]; do sleep 0.02; done; echo ' JobState=" +
                                         state + " '\n";
  const Outcome run = shell(
      "chmod +x scontrol; PATH=$PWD:$PATH setsid sh job.sh & job=$!; "
      "until [ -e ready ]; do sleep 0.02; done; kill -TERM -$job; "
      "until [ -e shown ]; do sleep 0.02; done; kill -TERM -$job; touch go; wait $job; echo code $?");
  EXPECT_THAT(run.out, testing::AnyOf(testing::HasSubstr("code 130"), testing::HasSubstr("code 143")))
      << run.err;
  EXPECT_EQ(std::filesystem::exists(path("requeued")), state != "COMPLETING");
}

INSTANTIATE_TEST_SUITE_P(Submit, ToldToStop, testing::Values("RUNNING", "SIGNALING", "COMPLETING"));

class Slurm : public WithSlurm {};

TEST_F(Slurm, FourShardsAndAJoinAreOneRun) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml -o one.mp4" + kSmallFilm).exit, 0);
  const Outcome run = obscura("submit scene.toml --tasks 4 -o room.mp4 --progress plain" + kSmallFilm);
  ASSERT_EQ(run.exit, 0) << run.err << contents(path("room.mp4.slurm/prepare.log"))
                         << contents(path("room.mp4.slurm/shard-1.log"))
                         << contents(path("room.mp4.slurm/join.log"));
  EXPECT_NE(run.out.find("room.mp4: 100 frames, made by 4 tasks"), std::string::npos) << run.out;
  EXPECT_TRUE(contents(path("room.mp4")) == contents(path("one.mp4")));
  const Outcome again = obscura("submit scene.toml --tasks 4 -o room.mp4" + kSmallFilm);
  EXPECT_EQ(again.exit, 0);
  EXPECT_NE(again.out.find("is complete"), std::string::npos) << again.out;

  // arrays here end at task 8
  const Outcome table =
      obscura("submit scene.toml --tasks 20 --vary seed=1:10 --measure hash@1 -o runs.csv --progress none");
  EXPECT_EQ(table.exit, 0) << table.err << contents(path("runs.csv.slurm/shard-1.log"));
  EXPECT_NE(table.err.find("up to 8 tasks"), std::string::npos) << table.err;
  EXPECT_EQ(contents(path("runs.csv")),
            obscura("sweep scene.toml --vary seed=1:10 --measure hash@1 --progress none").out);
}

TEST_F(Slurm, AFailedTaskIsNamedWithItsLogAndRepairedBySubmittingAgain) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml -o one.mp4" + kSmallFilm).exit, 0);
  const std::string submit = "submit scene.toml --tasks 4 -o room.mp4 --progress none" + kSmallFilm;
  // the scripts are a person's to change: shard 3 is made to fail
  ASSERT_EQ(obscura(submit + " --no-wait -- --hold").exit, 0);
  ASSERT_EQ(
      shell(
          "scancel $(squeue -h -o %A); cd room.mp4.slurm; sed -i /--hold/d *.sbatch; cp shards.sbatch good; "
          "sed -i 's/^cores=.*/&\\n[ $shard != 3 ] || { echo the lamp broke; exit 9; }/' shards.sbatch")
          .exit,
      0);
  ASSERT_TRUE(soon("test -z \"$(squeue -h -o %A)\""));
  const Outcome failed = obscura(submit);
  EXPECT_EQ(failed.exit, 4);
  for (const char* part :
       {"shard-3 failed, of 4 shards, FAILED", "room.mp4.slurm/shard-3.log: the lamp broke"})
    EXPECT_NE(failed.err.find(part), std::string::npos) << failed.err;
  EXPECT_FALSE(std::filesystem::exists(path("room.mp4")));

  ASSERT_EQ(shell("cd room.mp4.slurm; mv good shards.sbatch; rm shard-[124].log").exit, 0);
  const Outcome repaired = obscura(submit);
  EXPECT_EQ(repaired.exit, 0) << repaired.err;
  EXPECT_TRUE(contents(path("room.mp4")) == contents(path("one.mp4")));
  EXPECT_FALSE(std::filesystem::exists(path("room.mp4.slurm/shard-1.log")));  // nobody made it again
}

TEST_F(Slurm, WhoFollowsIsToldWhatIsHeld) {
  scene(kRoom);
  const std::string submit = "submit scene.toml --tasks 2 -o room.mp4 --progress none" + kSmallFilm;
  ASSERT_EQ(obscura(submit + " --no-wait -- --hold").exit, 0);
  shell("{ " OBSCURA_BINARY " " + submit + "; echo $?; } >followed 2>&1 & true");
  ASSERT_TRUE(soon("grep -q 'holds job 3 (.*); scontrol release 3 ' followed")) << contents(path("followed"));
  ASSERT_EQ(shell("scontrol release 1 2 3").exit, 0);
  ASSERT_TRUE(soon("tail -n 1 followed | grep -qx 0")) << contents(path("followed")) << story();
  EXPECT_TRUE(std::filesystem::exists(path("room.mp4")));
}

TEST_F(Slurm, ATaskThatIsToldToStopAndANodeThatDiesLoseNothing) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml -o one.mp4" + kSmallFilm).exit, 0);
  const std::string submit = "submit scene.toml --tasks 2 -o room.mp4 --progress none" + kSmallFilm;
  // the scripts are a person's to change: each task stands still at its ninth file, of two or three a part,
  // until it is told to go on
  ASSERT_EQ(obscura(submit + " --no-wait -- --hold").exit, 0);
  ASSERT_EQ(shell("scancel $(squeue -h -o %A); cd room.mp4.slurm; sed -i /--hold/d *.sbatch; "
                  "sed -i 's|^cores=.*|&\\n[ -s met$shard ] \\|\\| export FAULTS_UNDER=$PWD/room.mp4.parts "
                  "FAULTS_LOG=$PWD/met$shard FAULTS_WITH=STOP FAULTS_CALLS=rename FAULTS_NTH=9 "
                  "LD_PRELOAD=" OBSCURA_FAULTS "|' shards.sbatch")
                .exit,
            0);
  ASSERT_TRUE(soon("test -z \"$(squeue -h -o %A)\""));
  ASSERT_EQ(obscura(submit + " --no-wait").exit, 0);
  const std::string array = "$(awk '$1 == \"shards\" { print $2 }' room.mp4.slurm/jobs)";
  ASSERT_TRUE(soon("test -s met1 && test -s met2"))
      << story() << contents(path("room.mp4.slurm/shard-1.log"));

  // task 1 gets SIGTERM where it has a part, and goes on
  ASSERT_EQ(shell("ls room.mp4.parts/*000000-*.mp4").exit, 0);
  ASSERT_EQ(shell("scancel --full --signal=TERM " + array + "_1").exit, 0);
  // CONT again and again: the file met1 is there a moment before the task stands still. Not to a task that
  // has ended: scancel then tries for a minute and a half
  ASSERT_TRUE(soon("squeue -h -r -t RUNNING -j " + array +
                   " -o %K | grep -qx 1 && scancel --full --signal=CONT " + array + "_1; squeue -h -r -j " +
                   array + " -o '%K %T %r' | grep -qx '1 PENDING BeginTime'"))
      << story() << contents(path("room.mp4.slurm/shard-1.log"));
  ASSERT_TRUE(begun(array)) << story();

  // then the node dies, task 2 on it, and comes back
  ASSERT_EQ(shell("squeue -h -r -t RUNNING -j " + array + " -o %K | grep -qx 2").exit, 0) << story();
  kill_node();
  ASSERT_TRUE(soon("sinfo -h -o %T | grep -q down")) << story();
  start_node();
  ASSERT_TRUE(soon("sinfo -h -o %T | grep -qx -e idle -e mixed -e allocated"));
  ASSERT_TRUE(begun(array)) << story();
  Outcome followed = obscura(submit);
  // Slurm may let the join fall with the node: then it is what is missing
  if (followed.exit != 0) followed = obscura(submit);
  EXPECT_EQ(followed.exit, 0) << followed.err << story();
  EXPECT_TRUE(contents(path("room.mp4")) == contents(path("one.mp4")));
}

}  // namespace
}  // namespace obscura::app
