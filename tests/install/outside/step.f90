! Steps a scene to its end in Fortran and prints its state hash.   step SCENE
program step
  use iso_c_binding
  implicit none
  interface
    function scree_open(scene, comm, run, restart, threads, engine) bind(c)
      import :: c_int, c_ptr, c_char
      character(kind=c_char), intent(in) :: scene(*)
      type(c_ptr), value :: comm, run, restart
      integer(c_int), value :: threads
      type(c_ptr), intent(out) :: engine
      integer(c_int) :: scree_open
    end function
    function scree_run_until(engine, time) bind(c)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: engine
      real(c_double), value :: time
      integer(c_int) :: scree_run_until
    end function
    function scree_duration(engine) bind(c)
      import :: c_ptr, c_double
      type(c_ptr), value :: engine
      real(c_double) :: scree_duration
    end function
    function scree_state_hash(engine, text) bind(c)
      import :: c_int, c_ptr, c_char
      type(c_ptr), value :: engine
      character(kind=c_char), intent(out) :: text(33)
      integer(c_int) :: scree_state_hash
    end function
    function scree_close(engine) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: engine
      integer(c_int) :: scree_close
    end function
  end interface
  type(c_ptr) :: engine
  character(len=1000) :: scene
  character(kind=c_char) :: hash(33)
  call get_command_argument(1, scene)
  if (scree_open(trim(scene)//c_null_char, c_null_ptr, c_null_ptr, c_null_ptr, 1_c_int, engine) /= 0) stop 3
  if (scree_run_until(engine, scree_duration(engine)) /= 0) stop 5
  if (scree_state_hash(engine, hash) /= 0) stop 1
  print '(32a)', hash(1:32)
  if (scree_close(engine) /= 0) stop 1
end program
