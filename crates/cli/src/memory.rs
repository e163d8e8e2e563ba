//! Memory of this machine, where the system tells: on Linux.

use std::fs;
use std::path::{Component, Path, PathBuf};

/// Bytes that can be had without swapping: what is free, within what control groups (containers, services) allow.
pub(crate) fn available() -> Option<u64> {
    available_below(Path::new("/"))
}

/// [`available`] by the files below a folder that stands for the root of the file system.
fn available_below(root: &Path) -> Option<u64> {
    let free = free_bytes(&fs::read_to_string(root.join("proc/meminfo")).ok()?)?;
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    let rooms = VERSIONS.iter().filter_map(|version| version.room(root, &groups));
    Some(rooms.fold(free, u64::min))
}

/// Bytes that are free or can be freed, by the text of `/proc/meminfo`.
fn free_bytes(meminfo: &str) -> Option<u64> {
    number_after("MemAvailable:", meminfo)?.checked_mul(1024)
}

/// Where a version of the control groups tells of memory.
struct Version {
    /// What names its lines in `/proc/self/cgroup`: a controller, or nothing in version 2.
    controller: &'static str,
    /// Folder of the topmost group.
    mount: &'static str,
    /// File of the bytes that a group may have at the most; `max` if they are not limited.
    limit: &'static str,
    /// File of the bytes that it has, with its subgroups and the copies of files.
    usage: &'static str,
    /// Lines of `memory.stat`: copies of files, which the system drops where memory gets scarce.
    files: [&'static str; 2],
}

const VERSIONS: [Version; 2] = [
    Version {
        controller: "",
        mount: "sys/fs/cgroup",
        limit: "memory.max",
        usage: "memory.current",
        files: ["inactive_file", "active_file"],
    },
    Version {
        controller: "memory",
        mount: "sys/fs/cgroup/memory",
        limit: "memory.limit_in_bytes",
        usage: "memory.usage_in_bytes",
        files: ["total_inactive_file", "total_active_file"],
    },
];

impl Version {
    /// Bytes that the process may still take: each group above its own may limit it too. None without a limit.
    fn room(&self, root: &Path, groups: &str) -> Option<u64> {
        // In a container that does not see this path the topmost folder is its own group.
        let own = own_group(self.controller, groups)?;
        let mount = root.join(self.mount);
        own.ancestors().filter_map(|group| self.room_in(&mount.join(group))).min()
    }

    /// Bytes that one group may still take. None where it has no limit, or files are missing.
    fn room_in(&self, group: &Path) -> Option<u64> {
        let read = |name| fs::read_to_string(group.join(name)).ok();
        let bytes = |name| read(name)?.trim().parse::<u64>().ok();
        let (limit, usage) = (bytes(self.limit)?, bytes(self.usage)?);
        let stat = read("memory.stat").unwrap_or_default();
        let files: u64 = self.files.iter().filter_map(|name| number_after(name, &stat)).sum();
        Some(limit.saturating_sub(usage.saturating_sub(files)))
    }
}

/// The process's group, below the topmost one, by the text of `/proc/self/cgroup`: lines `number:controllers:/group`.
fn own_group(controller: &str, groups: &str) -> Option<PathBuf> {
    let group = groups.lines().find_map(|line| {
        let (controllers, group) = line.split_once(':')?.1.split_once(':')?;
        controllers.split(',').any(|name| name == controller).then_some(group)
    })?;
    let path = Path::new(group.trim_start_matches('/'));
    // A group beside those that the process sees begins with `..`: the topmost one must do for it.
    let is_seen = path.components().all(|part| matches!(part, Component::Normal(_)));
    Some(if is_seen { path.into() } else { PathBuf::new() })
}

/// The number in the line that begins with this word.
fn number_after(word: &str, text: &str) -> Option<u64> {
    text.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        if words.next() == Some(word) { words.next()?.parse().ok() } else { None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    const MEMINFO: &str = "MemTotal:  2000 kB\nMemFree:  10 kB\nMemAvailable:  1000 kB\n";

    /// A folder with these files, and a megabyte (of 1024 x 1000 bytes) free.
    fn tree(files: &[(&str, &str)]) -> TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in [&[("proc/meminfo", MEMINFO)], files].concat() {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    fn available(files: &[(&str, &str)]) -> Option<u64> {
        available_below(tree(files).path())
    }

    #[test]
    fn numbers_are_those_of_whole_words() {
        let stat = "active_file 1\ninactive_file 22\nfile x\nbare\n";
        assert_eq!(number_after("inactive_file", stat), Some(22));
        assert_eq!(number_after("active_file", stat), Some(1));
        for missing in ["active", "file", "bare", "other", ""] {
            assert_eq!(number_after(missing, stat), None, "{missing}");
        }
        assert_eq!(free_bytes(MEMINFO), Some(1_024_000));
        assert_eq!(free_bytes("MemFree: 1000 kB\n"), None);
    }

    #[test]
    fn own_group_is_found() {
        let groups = "5:cpu,cpuacct:/jobs\n4:memory:/a/b:c\n1:name=systemd:/s\n0::/x/y\n";
        assert_eq!(own_group("", groups), Some("x/y".into()));
        assert_eq!(own_group("memory", groups), Some("a/b:c".into()));
        assert_eq!(own_group("cpuacct", groups), Some("jobs".into()));
        assert_eq!(own_group("pids", groups), None);
        assert_eq!(own_group("", "0::/\n"), Some(PathBuf::new()));
        assert_eq!(own_group("", "0::/../../other\n"), Some(PathBuf::new()));
        assert_eq!(own_group("memory", "no line of that kind\n"), None);
    }

    #[test]
    fn without_groups_all_that_is_free_counts() {
        assert_eq!(available(&[]), Some(1_024_000));
        assert_eq!(available(&[("proc/self/cgroup", "0::/user\n")]), Some(1_024_000));
        let unlimited = [
            ("proc/self/cgroup", "0::/user\n"),
            ("sys/fs/cgroup/user/memory.max", "max\n"),
            ("sys/fs/cgroup/user/memory.current", "500000\n"),
        ];
        assert_eq!(available(&unlimited), Some(1_024_000));
        assert_eq!(available_below(Path::new("/no such folder")), None);
    }

    #[test]
    fn copies_of_files_count_as_free() {
        let mut files = vec![
            ("proc/self/cgroup", "0::/\n"),
            ("sys/fs/cgroup/memory.max", "1000000\n"),
            ("sys/fs/cgroup/memory.current", "900000\n"),
        ];
        assert_eq!(available(&files), Some(100_000));
        files.push(("sys/fs/cgroup/memory.stat", "anon 200000\nactive_file 300000\n"));
        assert_eq!(available(&files), Some(400_000));
        files.push(("sys/fs/cgroup/memory.stat", "inactive_file 400000\nactive_file 300000\n"));
        assert_eq!(available(&files), Some(800_000));
        // The files are not read at one moment.
        files.push(("sys/fs/cgroup/memory.stat", "inactive_file 950000\n"));
        assert_eq!(available(&files), Some(1_000_000));
        files.push(("sys/fs/cgroup/memory.max", "800000\n"));
        files.push(("sys/fs/cgroup/memory.stat", "inactive_file 0\n"));
        assert_eq!(available(&files), Some(0));
        files.push(("sys/fs/cgroup/memory.current", "no number\n"));
        assert_eq!(available(&files), Some(1_024_000));
    }

    #[test]
    fn smallest_room_of_nested_groups_counts() {
        let mut files = vec![
            ("proc/self/cgroup", "0::/slice/service/inner\n"),
            ("sys/fs/cgroup/slice/memory.max", "900000\n"),
            ("sys/fs/cgroup/slice/memory.current", "700000\n"),
            ("sys/fs/cgroup/slice/memory.stat", "inactive_file 100000\n"),
            ("sys/fs/cgroup/slice/service/memory.max", "max\n"),
            ("sys/fs/cgroup/slice/service/memory.current", "700000\n"),
            ("sys/fs/cgroup/slice/other/memory.max", "5\n"),
            ("sys/fs/cgroup/slice/other/memory.current", "5\n"),
        ];
        assert_eq!(available(&files), Some(300_000));
        files.push(("sys/fs/cgroup/slice/service/inner/memory.max", "600000\n"));
        files.push(("sys/fs/cgroup/slice/service/inner/memory.current", "350000\n"));
        assert_eq!(available(&files), Some(250_000));
    }

    #[test]
    fn first_version_is_understood() {
        let mut files = vec![
            ("proc/self/cgroup", "4:memory:/job/part\n0::/\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "900000\n"),
        ];
        assert_eq!(available(&files), Some(1_024_000));
        files.extend([
            ("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "800000\n"),
            ("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "700000\n"),
            (
                "sys/fs/cgroup/memory/job/memory.stat",
                "inactive_file 1\nactive_file 1\ntotal_inactive_file 30000\ntotal_active_file 20000\n",
            ),
        ]);
        assert_eq!(available(&files), Some(150_000));
        // A container that sees its group as the topmost one, under a path that it does not see.
        files.push(("proc/self/cgroup", "4:memory:/docker/0123abc\n"));
        files.push(("sys/fs/cgroup/memory/memory.limit_in_bytes", "1000000\n"));
        assert_eq!(available(&files), Some(100_000));
    }
}
