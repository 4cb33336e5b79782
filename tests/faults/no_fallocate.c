/* Preloaded by a test: makes every file system one that cannot reserve space, as ext2, ext3 and NFS 3 cannot. */
#include <errno.h>
#include <sys/types.h>

int fallocate(int file, int mode, off_t offset, off_t length) {
  (void)file, (void)mode, (void)offset, (void)length;
  errno = EOPNOTSUPP;
  return -1;
}
