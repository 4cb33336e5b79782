// A tool that is started once and run many times: libraries are loaded, and sanitizers begin, once. Each run is a copy of the process, or,
// with the argument --one-process, a call of main() in this one: several times faster, for tools that never start MPI, which a process
// starts once. Linked with the object files of the tool and --wrap=main, so that main() of the tool is __real_main() here.
//
// Reads requests from stdin, each a line with the count of words and the words, one a line: the arguments of main() with the name of the
// tool as the first. What the run says is in the file `said` of the working folder. Answers each request with one line: the exit code, or
// minus the number of the signal. A run that lasts longer than kLongest seconds ends by SIGALRM. In one process the run's end is the
// server's.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

extern "C" int __real_main(int argc, char** argv);  // NOLINT(bugprone-reserved-identifier): names of the linker
extern "C" int __wrap_main(int argc, char** argv);  // NOLINT(bugprone-reserved-identifier)

namespace {

constexpr unsigned kLongest = 300;  // [s]

int be_the_tool(std::vector<std::string> words) {
  const int said = open("said", O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (said < 0 || dup2(said, STDOUT_FILENO) < 0 || dup2(said, STDERR_FILENO) < 0) _exit(125);
  close(said);
  alarm(kLongest);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int code = __real_main(static_cast<int>(words.size()), arguments.data());
  alarm(0);
  std::fflush(stdout);
  return code;
}

int answer_of_copy(std::vector<std::string> words) {
  const pid_t process = fork();
  if (process == 0) std::exit(be_the_tool(std::move(words)));
  int status = 0;
  if (process < 0 || waitpid(process, &status, 0) != process) std::exit(125);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

extern "C" int __wrap_main(int argc, char** argv) {
  const bool is_one_process = argc > 1 && std::string_view(argv[1]) == "--one-process";
  // requests and answers have descriptors of their own; the tool finds nothing on its stdin
  std::FILE* const answers = fdopen(dup(STDOUT_FILENO), "w");
  std::FILE* const requests = fdopen(dup(STDIN_FILENO), "r");
  const int nothing = open("/dev/null", O_RDONLY);
  if (answers == nullptr || requests == nullptr || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0) return 125;
  char* line = nullptr;
  std::size_t room = 0;
  const auto next_line = [&] {
    const ssize_t length = getline(&line, &room, requests);
    return length > 0 ? std::optional(std::string(line, static_cast<std::size_t>(length) - 1)) : std::nullopt;
  };
  while (const auto count = next_line()) {
    std::vector<std::string> words(std::stoul(*count));
    for (std::string& word : words) word = next_line().value_or("");
    const int answer = is_one_process ? be_the_tool(std::move(words)) : answer_of_copy(std::move(words));
    std::fprintf(answers, "%d\n", answer);
    std::fflush(answers);
  }
  std::free(line);
  return 0;
}
