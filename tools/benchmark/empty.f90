!> Do nothing: measure a process that loads epcont and its libraries.
program bench_empty
  implicit none
end program bench_empty
