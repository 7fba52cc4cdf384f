#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "needs.h"
#include "program.h"

namespace obscura::app {

/// A whole Slurm of four processors on the loopback, in the test's own folder: munged, slurmctld, slurmd, as
/// whoever runs the test.
class WithSlurm : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    ::setenv("PATH", (std::string(std::getenv("PATH")) + ":/usr/sbin:/sbin").c_str(), 1);
    const bool there =
        installed("munged") && installed("slurmctld") && installed("slurmd") && installed("sbatch");
    OBSCURA_NEEDS(there, "munge slurmctld slurmd slurm-client");
    // no package helps: a machine without control groups has no slurmd
    if (shell("grep -q ' cgroup' /proc/mounts").exit != 0)
      GTEST_SKIP() << "slurmd needs control groups, and none are mounted here";
    ::setenv("SLURM_CONF", path("slurm.conf").c_str(), 1);
    std::ofstream(path("slurm.conf")) << configuration();
    ASSERT_EQ(
        shell("mkdir state spool; head -c 128 /dev/urandom >munge.key; chmod 600 munge.key; chmod 755 .")
            .exit,
        0);
    munged_ = start(
        "munged --foreground --force --socket=$PWD/munge.socket --key-file=$PWD/munge.key "
        "--pid-file=$PWD/munged.pid --seed-file=$PWD/munge.seed --log-file=$PWD/munged.log");
    ASSERT_TRUE(soon("test -S munge.socket")) << contents(path("munged.out"));
    controller_ = start("slurmctld -D -i");
    ASSERT_TRUE(soon("sinfo -h")) << contents(path("slurmctld.log"));
    start_node();
    ASSERT_TRUE(soon("sinfo -h -o %T | grep -qx -e idle")) << contents(path("slurmd.log"));
  }
  void TearDown() override {
    if (!controller_.empty()) {
      shell("scancel --full $(squeue -h -o %A); scancel $(squeue -h -o %A)");
      soon("test -z \"$(squeue -h -o %A)\"");
    }
    for (const std::string* pid : {&node_, &controller_, &munged_})
      if (!pid->empty()) shell("kill -KILL " + *pid);
    Program::TearDown();
  }

  void start_node() { node_ = start("slurmd -D"); }

  /// The node as after a power cut: nothing of it is left.
  void kill_node() {
    shell("kill -KILL " + node_ +
          "; for p in /proc/[0-9]*; do "
          "if tr '\\0' '\\n' <$p/environ 2>/dev/null | grep -qx \"SLURM_CONF=$SLURM_CONF\" && "
          "{ grep -q ^slurmstepd $p/comm || tr '\\0' '\\n' <$p/environ | grep -q ^SLURM_JOB_ID=; }; "
          "then kill -KILL ${p#/proc/}; fi; done; rm -rf spool; mkdir spool");
  }

  /// What Slurm knows, for one who asks why.
  std::string story() const {
    return shell("squeue -t all -r").out + contents(path("slurmctld.log")) + contents(path("slurmd.log"));
  }

  /// Whether a command comes to succeed: twenty minutes are more than any of them takes anywhere.
  bool soon(const std::string& command) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(20);
    while (std::chrono::steady_clock::now() < end) {
      if (shell("{ " + command + "; } >/dev/null").exit == 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  /// Slurm lets what it queues again wait for two minutes; a test waits for two seconds. Not for less: what
  /// is launched in the second in which it ended is refused, its credential being counted as the old one's,
  /// and may be held. Whether all tasks of an array have begun.
  bool begun(const std::string& array) const {
    const std::string waiting = "squeue -h -r -t PENDING -j " + array;
    return soon("sleep 2; " + waiting +
                " -o '%A %r' | while read j why; do case $why in "
                "BeginTime) scontrol update jobid=$j starttime=now ;; *held) scontrol release $j ;; "
                "esac; done; sleep 1; test -z \"$(" +
                waiting + " -o %A)\"");
  }

 private:
  /// Two ports of the loopback that nothing listens on: the kernel names them.
  static std::array<int, 2> free_ports() {
    std::array<int, 2> ports{}, sockets{};
    for (std::size_t i = 0; i < ports.size(); ++i) {
      sockets[i] = ::socket(AF_INET, SOCK_STREAM, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET, address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socklen_t size = sizeof address;
      ::bind(sockets[i], reinterpret_cast<sockaddr*>(&address), size);
      ::getsockname(sockets[i], reinterpret_cast<sockaddr*>(&address), &size);
      ports[i] = ntohs(address.sin_port);
    }
    for (const int each : sockets) ::close(each);
    return ports;
  }

  std::string configuration() const {
    const std::string host = shell("hostname -s").out.substr(0, shell("hostname -s").out.find('\n'));
    const std::string user = shell("id -un").out.substr(0, shell("id -un").out.find('\n'));
    const auto ports = free_ports();
    const std::string here = folder_.string() + "/";
    return "ClusterName=obscura\nSlurmctldHost=" + host +
           "(127.0.0.1)\nSlurmctldPort=" + std::to_string(ports[0]) +
           "\nSlurmdPort=" + std::to_string(ports[1]) + "\nAuthType=auth/munge\nAuthInfo=socket=" + here +
           "munge.socket\nSlurmUser=" + user + "\nSlurmdUser=" + user + "\nStateSaveLocation=" + here +
           "state\nSlurmdSpoolDir=" + here + "spool\nSlurmctldPidFile=" + here +
           "slurmctld.pid\nSlurmdPidFile=" + here + "slurmd.pid\nSlurmctldLogFile=" + here +
           "slurmctld.log\nSlurmdLogFile=" + here +
           "slurmd.log\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
           "JobAcctGatherType=jobacct_gather/none\nSelectType=select/"
           "cons_tres\nSelectTypeParameters=CR_CPU\nSwitchType=switch/"
           "none\nMpiDefault=none\nReturnToService=2\n"
           "MaxArraySize=9\nKillWait=2\nSlurmdTimeout=30\nSlurmdParameters=config_overrides\n"
           "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0\nNodeName=" +
           host +
           " NodeAddr=127.0.0.1 CPUs=4 RealMemory=1000 State=UNKNOWN\nPartitionName=all Nodes=" + host +
           " Default=YES MaxTime=INFINITE State=UP\n";
  }
  /// A process that goes on, its words in a file; its number.
  std::string start(const std::string& command) const {
    const std::string name = command.substr(0, command.find(' '));
    const std::string pid = shell(command + " >" + name + ".out 2>&1 & echo $!").out;
    return pid.substr(0, pid.find('\n'));
  }

  std::string munged_, controller_, node_;
};

}  // namespace obscura::app
