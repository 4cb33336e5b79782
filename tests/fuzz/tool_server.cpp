// A tool that is started once and run many times, each time in a copy of the process: libraries are loaded, and sanitizers begin, once.
// Linked with the object files of the tool and --wrap=main, so that main() of the tool is __real_main() here.
//
// Reads requests from stdin, each a line with the count of words and the words, one a line: the arguments of main() with the name of the
// tool as the first. What the run says is in the file `said` of the working folder. Answers each request with one line: the exit code, or
// minus the number of the signal. A run that lasts longer than kLongest seconds ends by SIGALRM.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

extern "C" int __real_main(int argc, char** argv);  // NOLINT(bugprone-reserved-identifier): names of the linker
extern "C" int __wrap_main(int argc, char** argv);  // NOLINT(bugprone-reserved-identifier)

namespace {

constexpr unsigned kLongest = 300;  // [s]

[[noreturn]] void be_the_tool(std::vector<std::string> words) {
  const int said = open("said", O_WRONLY | O_CREAT | O_TRUNC, 0666), nothing = open("/dev/null", O_RDONLY);
  if (said < 0 || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(said, STDOUT_FILENO) < 0 || dup2(said, STDERR_FILENO) < 0)
    _exit(125);
  close(said);
  close(nothing);
  alarm(kLongest);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::exit(__real_main(static_cast<int>(words.size()), arguments.data()));
}

}  // namespace

extern "C" int __wrap_main(int, char**) {
  for (std::string line; std::getline(std::cin, line);) {
    std::vector<std::string> words(std::stoul(line));
    for (std::string& word : words) std::getline(std::cin, word);
    const pid_t process = fork();
    if (process == 0) be_the_tool(std::move(words));
    int status = 0;
    if (process < 0 || waitpid(process, &status, 0) != process) return 125;
    std::printf("%d\n", WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status));
    std::fflush(stdout);
  }
  return 0;
}
